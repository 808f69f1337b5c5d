#pragma once

#include <array>
#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// A place on a finger's skin, the same material at rest and deformed.
struct SkinPlace {
  int triangle = 0;                 ///< of FingerModel::skin_triangles
  std::array<double, 3> weights{};  ///< of its corners
};

/// Where it is while nothing touches, in F, m.
[[nodiscard]] Vector3 rest_position(const FingerModel& model, const SkinPlace& place);

/// Places all over a finger's skin, and the area at rest that each stands for, m^2.
struct SkinPlaces {
  std::vector<SkinPlace> places;  ///< by triangle
  std::vector<double> areas;
};

/// The centroids of the equal parts into which triangles are divided until no side of a part is
/// longer than `spacing`, m.
[[nodiscard]] SkinPlaces even_places(const FingerModel& model, double spacing);

/// Finds places on a finger's skin at rest. Refers to the model.
class RestingSkin {
 public:
  explicit RestingSkin(const FingerModel& model);

  /// The place nearest to p_F (F, m).
  [[nodiscard]] SkinPlace nearest(const Vector3& p_F) const;

 private:
  struct Ball {
    Vector3 centre;
    double radius;
  };
  const FingerModel& model_;
  std::vector<Ball> around_;  ///< each triangle
};

}  // namespace softfinger
