#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/contact/contact_set.hpp"

namespace softfinger {

/// The skin that a contact set is about, at rest.
struct SkinSurface {
  std::span<const Vector3> nodes;                 ///< of the whole mesh, F, m
  std::span<const int> sample_nodes;              ///< node of each sample
  std::span<const double> sample_areas;           ///< a third of its triangles, m^2
  std::span<const std::array<int, 3>> triangles;  ///< of samples, outward
  double plane_modulus = std::numeric_limits<double>::infinity();  ///< E / (1 - nu^2) of the tissue
                                                                   ///< under it, Pa
  [[nodiscard]] const Vector3& position(int sample) const {
    return nodes[static_cast<std::size_t>(sample_nodes[static_cast<std::size_t>(sample)])];
  }
};

/// Where a point of the potential beyond the samples is: it meets one obstacle in a triangle.
struct FeaturePlace {
  int obstacle = -1;
  std::array<int, 3> samples{};      ///< corners of the triangle
  std::array<double, 3> weights{};   ///< of the corners
  Vector3 offset = Vector3::Zero();  ///< from the skin to the point, W, m
};

/// What has been evaluated last.
struct SettledContact {
  const ContactPotential& potential;
  std::span<const Vector3> positions;      ///< of the samples, and after them of features, W, m
  std::span<const FeaturePlace> features;  ///< at most ContactSet::kMostFeatures
  double feature_depth = 0.0;              ///< of their points under the skin, m
  double tolerance = 0.0;                  ///< greatest gap of a sample in contact, m
  Pose X_WF;
};

/// A contact set with one entry per skin sample, nothing touching.
[[nodiscard]] ContactSet make_contact_set(const SkinSurface& skin, double friction_coefficient);

/// Fills `set`, expressed in F: who is in C, and what they bear. Allocates nothing.
void report_contact(const SkinSurface& skin, const SettledContact& contact, ContactSet& set);

}  // namespace softfinger
