#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "softfinger/contact/contact_sums.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// One skin sample (a vertex of the mesh group `skin`) against the object nearest to it.
/// Vectors are expressed in F, the simulated distal phalanx.
struct ContactSample {
  Vector3 position_F = Vector3::Zero();                  ///< deformed position, m
  Vector3 skin_normal_F = -Vector3::UnitZ();             ///< unit, out of the deformed skin
  Vector3 normal_F = Vector3::UnitZ();                   ///< unit, out of the object
  double gap = std::numeric_limits<double>::infinity();  ///< signed distance to the object, m
  double normal_force = 0.0;                             ///< |normal_force_F|, N
  Vector3 normal_force_F =
      Vector3::Zero();  ///< N, object on skin, with what features near it carry
  Vector3 tangential_force_F = Vector3::Zero();  ///< N, object on skin, likewise
  double own_normal_force = 0.0;  ///< magnitude of what it bears itself, without features, N
  double rest_area = 0.0;         ///< a third of its skin triangles at rest, m^2
  double area = 0.0;              ///< the same, deformed, m^2
  double taken = 0.0;             ///< part of its area that features in contact stand for, 0 to 1
  double friction_limit = 0.0;    ///< mu times the normal force, N
  bool slides = false;            ///< tangential force at its limit
  bool in_contact = false;        ///< member of C (else of N)
  int object = -1;                ///< index of the nearest object, -1 if there is none
  bool on_soft = false;           ///< that object is soft

  /// Area at rest that the sample itself stands for, m^2.
  [[nodiscard]] double weight() const { return (1.0 - taken) * rest_area; }
  /// Part of its area that is in contact, by itself or by features, 0 to 1.
  [[nodiscard]] double touched() const { return in_contact ? 1.0 : taken; }
  [[nodiscard]] double pressure() const { return area > 0.0 ? normal_force / area : 0.0; }  ///< Pa
};

/// A point inside a skin triangle where a feature of an object finer than the triangles (an edge, a
/// corner) presses: a member of C. What it carries its corners have too. Vectors are expressed in
/// F.
struct ContactFeature {
  std::array<int, 3> samples{};  ///< corners of its triangle
  std::array<double, 3> weights{};
  Vector3 position_F = Vector3::Zero();          ///< on the deformed skin, m
  double gap = 0.0;                              ///< of the skin there, m
  double excess = 0.0;                           ///< by how much it is out of contact there, m
  Vector3 normal_force_F = Vector3::Zero();      ///< N, object on skin
  Vector3 tangential_force_F = Vector3::Zero();  ///< N, object on skin
  double rest_area = 0.0;  ///< of the part of its triangle nearer to it than to the corners, m^2
  double area = 0.0;       ///< the same, deformed, m^2
  bool slides = false;     ///< tangential force at its limit
  int object = -1;         ///< index of the object that presses
};

/// How much of a triangle of the skin is in contact, see report_area().
struct TriangleContact {
  enum class Extent : std::uint8_t {
    kNone,
    kPart,  ///< where `excess`, linear between its places and features, is at most 0
    kAll
  };
  static constexpr std::size_t kPlaces = 6;  ///< its corners and the middles of its sides

  Extent extent = Extent::kNone;
  /// By how much the skin at each place is out of contact, m; known where the extent is kPart.
  std::array<double, kPlaces> excess{};
};

/// The paper's sets C and N over all skin samples, with their sums.
/// A sample is in C when its gap is at most the finger's tolerance and the normal force on itself,
/// without what features hand to it, exceeds 1e-6 N; a feature is in C while it bears more than
/// that. So C bears all of the force.
struct ContactSet : ContactSums {
  static constexpr std::size_t kMostFeatures = 64;

  std::vector<ContactSample> samples;
  std::vector<TriangleContact> triangles;  ///< of the skin
  std::array<ContactFeature, kMostFeatures> feature_places;
  std::size_t feature_count = 0;
  [[nodiscard]] std::span<const ContactFeature> features() const {
    return {feature_places.data(), std::min(feature_count, kMostFeatures)};
  }
  /// Of the obstacle at the member of C with the greatest normal force; of the last one touched
  /// where C is empty, at first the finger's.
  double friction_coefficient = 0.0;
  Vector3 nearest_normal_F = Vector3::UnitZ();  ///< object's normal at the sample of least gap
};

}  // namespace softfinger
