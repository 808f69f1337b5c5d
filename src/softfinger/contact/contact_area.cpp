#include "softfinger/contact/contact_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "softfinger/geometry/curved_triangle.hpp"

namespace softfinger {
namespace {

using Weights = TriangleLattice::Weights;
constexpr std::size_t kPlaces = TriangleLattice::kPlaces;

/// Triangles without a corner nearer than this part of their longest side touch nowhere: so much
/// is a side bent whose ends face directions 70 degrees apart.
constexpr double kReach = 0.15;
/// What an obstacle may come nearer inside a triangle than its tangent planes at the corners tell,
/// where it is hollow, m.
constexpr double kHollow = 5e-5;

/// A triangle of the skin in contact.
class SkinTriangle {
 public:
  SkinTriangle(const SkinSurface& skin, const SettledContact& contact, const ContactSet& set,
               const std::array<int, 3>& samples)
      : skin_(skin), contact_(contact), set_(set), samples_(samples) {
    for (std::size_t k = 0; k < 3; ++k)
      corners_[k] = &set.samples[static_cast<std::size_t>(samples[k])];
  }

  /// Area in contact; fills `contact`.
  [[nodiscard]] double look_at(TriangleContact& contact) const {
    contact.extent = TriangleContact::Extent::kAll;
    if (is_pressed()) return area();
    contact.extent = TriangleContact::Extent::kNone;
    const bool has_feature =
        std::any_of(set_.features().begin(), set_.features().end(),
                    [this](const ContactFeature& feature) { return feature.samples == samples_; });
    if (!has_feature && !is_near()) return 0.0;
    const CurvedTriangle curved(
        {position(0), position(1), position(2)},
        {corners_[0]->skin_normal_F, corners_[1]->skin_normal_F, corners_[2]->skin_normal_F});
    if (!has_feature && !may_touch(curved)) return 0.0;
    DividedTriangle divided;
    look_inside(curved, divided);
    contact.extent = TriangleContact::Extent::kPart;
    for (std::size_t k = 0; k < kPlaces; ++k) contact.excess[k] = divided.places[k].excess;
    if (has_feature) divide_at_features(divided);
    return divided.area_within();
  }

 private:
  [[nodiscard]] const Vector3& position(std::size_t k) const { return corners_[k]->position_F; }
  [[nodiscard]] double area() const {
    return 0.5 * (position(1) - position(0)).cross(position(2) - position(0)).norm();
  }
  /// Pressed at all three corners.
  [[nodiscard]] bool is_pressed() const {
    return corners_[0]->in_contact && corners_[1]->in_contact && corners_[2]->in_contact;
  }
  [[nodiscard]] bool is_near() const {
    const double least = std::min({corners_[0]->gap, corners_[1]->gap, corners_[2]->gap});
    const double longest = std::max({(position(1) - position(0)).squaredNorm(),
                                     (position(2) - position(1)).squaredNorm(),
                                     (position(0) - position(2)).squaredNorm()});
    const double beyond = least - contact_.tolerance;
    return beyond <= 0.0 || beyond * beyond <= kReach * kReach * longest;
  }
  /// By the obstacles' tangent planes at the corners: outside of a solid that bulges they are never
  /// further off than it is, and the skin is in the hull of its control points.
  [[nodiscard]] bool may_touch(const CurvedTriangle& curved) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3& normal = corners_[k]->normal_F;
      const double most = contact_.tolerance + kHollow - corners_[k]->gap + normal.dot(position(k));
      if ((normal.transpose() * curved.control_points()).minCoeff() <= most) return true;
    }
    return false;
  }
  void look_inside(const CurvedTriangle& curved, DividedTriangle& divided) const {
    const TriangleLattice& lattice = TriangleLattice::get();
    const Eigen::Matrix<double, 3, kPlaces> positions = curved.control_points() * lattice.basis;
    // How much less the gap counts at the corners.
    Weights held;
    for (std::size_t k = 0; k < 3; ++k) {
      held[k] = punch_depth(corners_[k]->own_normal_force, corners_[k]->area, skin_.plane_modulus);
    }
    for (std::size_t k = 0; k < kPlaces; ++k) {
      SkinPoint& place = divided.places[k];
      place.position_F = positions.col(static_cast<Eigen::Index>(k));
      const int corner = lattice.corner[k];
      const double gap = corner >= 0 ? corners_[static_cast<std::size_t>(corner)]->gap
                                     : gap_at(place.position_F, lattice.nearest[k]);
      const Weights& weights = lattice.weights[k];
      place.excess = gap - contact_.tolerance - weights[0] * held[0] - weights[1] * held[1] -
                     weights[2] * held[2];
    }
  }
  /// To the obstacles that are nearest to the corners.
  [[nodiscard]] double gap_at(const Vector3& position_F, int nearest) const {
    double least = std::numeric_limits<double>::infinity();
    const Vector3 position_W = contact_.X_WF * position_F;
    for (std::size_t k = 0; k < 3; ++k) {
      const int o = corners_[k]->object;
      const bool again = (k > 0 && o == corners_[0]->object) || (k > 1 && o == corners_[1]->object);
      if (o < 0 || again) continue;
      const auto obstacle = static_cast<std::size_t>(o);
      const auto sample = static_cast<std::size_t>(samples_[static_cast<std::size_t>(nearest)]);
      if (!contact_.potential.may_meet(sample, obstacle)) continue;
      const Vector3 position_O = contact_.potential.obstacle_view(sample, obstacle) * position_W;
      least = std::min(least, contact_.potential.look(sample, obstacle, position_O).distance);
    }
    return least;
  }
  void divide_at_features(DividedTriangle& divided) const {
    for (const ContactFeature& feature : set_.features()) {
      if (feature.samples != samples_) continue;
      divided.divide_at(feature.weights, {feature.position_F, feature.excess});
    }
  }

  const SkinSurface& skin_;
  const SettledContact& contact_;
  const ContactSet& set_;
  const std::array<int, 3>& samples_;
  std::array<const ContactSample*, 3> corners_;
};

}  // namespace

double punch_depth(double force, double area, double plane_modulus) {
  if (!(force > 0.0) || !(area > 0.0)) return 0.0;
  return 0.5 * std::sqrt(std::numbers::pi / area) * force / plane_modulus;
}

void report_area(const SkinSurface& skin, const SettledContact& contact, ContactSet& set) {
  for (std::size_t k = 0; k < set.features().size(); ++k) {
    ContactFeature& feature = set.feature_places[k];
    const double force = feature.normal_force_F.norm();
    feature.excess =
        feature.gap - punch_depth(force, feature.area, skin.plane_modulus) - contact.tolerance;
  }
  set.contact_area = 0.0;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    set.contact_area +=
        SkinTriangle(skin, contact, set, skin.triangles[t]).look_at(set.triangles[t]);
  }
}

TriangleInContact::TriangleInContact(const ContactSet& set, std::size_t triangle,
                                     const std::array<int, 3>& samples)
    : extent_(set.triangles[triangle].extent) {
  if (extent_ != TriangleContact::Extent::kPart) return;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    divided_.places[k].excess = set.triangles[triangle].excess[k];
  }
  for (const ContactFeature& feature : set.features()) {
    if (feature.samples != samples) continue;
    divided_.divide_at(feature.weights, {feature.position_F, feature.excess});
  }
}

bool TriangleInContact::has(const std::array<double, 3>& weights) const {
  if (extent_ != TriangleContact::Extent::kPart) return extent_ == TriangleContact::Extent::kAll;
  return divided_.excess_at(weights) <= 0.0;
}

}  // namespace softfinger
