#pragma once

#include <array>
#include <cstddef>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/geometry/curved_triangle.hpp"

namespace softfinger {

/// Where a triangle of the skin is looked at: its corners and the middles of its sides.
struct TriangleLattice {
  static constexpr std::size_t kPlaces = TriangleContact::kPlaces;
  using Weights = std::array<double, 3>;    ///< of the corners
  using Part = std::array<std::size_t, 3>;  ///< a triangle between places

  std::array<Weights, kPlaces> weights;
  Eigen::Matrix<double, CurvedTriangle::kControlPoints, kPlaces> basis;
  std::array<int, kPlaces> corner;   ///< that the place is; -1: none
  std::array<int, kPlaces> nearest;  ///< corner
  std::array<Part, 4> parts;

  [[nodiscard]] static const TriangleLattice& get();

 private:
  TriangleLattice();
  void add(std::size_t place, const Weights& of);
};

/// A place on the skin, and by how much it is out of contact (m, negative within).
struct SkinPoint {
  Vector3 position_F = Vector3::Zero();
  double excess = 0.0;
};

/// Area of a triangle of skin where an excess that is linear in it is at most 0, m^2.
[[nodiscard]] double area_within(const SkinPoint& a, const SkinPoint& b, const SkinPoint& c);

/// A triangle of the skin, divided at the places of the lattice, and further at features. The
/// excess is linear in each part.
class DividedTriangle {
 public:
  using Weights = TriangleLattice::Weights;
  /// Features that it is divided at besides; any more are passed over.
  static constexpr std::size_t kMostInside = 4;

  /// The lattice's places first.
  std::array<SkinPoint, TriangleLattice::kPlaces + kMostInside> places;

  DividedTriangle();
  /// One more place divides the part that it is in.
  void divide_at(const Weights& weights, const SkinPoint& place);
  [[nodiscard]] double area_within() const;
  [[nodiscard]] double excess_at(const Weights& weights) const;

 private:
  using Part = TriangleLattice::Part;
  /// Weights of a part's corners there; none is negative where the part has the place.
  [[nodiscard]] Weights weights_in(const Part& part, const Weights& p) const;

  std::array<Weights, TriangleLattice::kPlaces + kMostInside> weights_;
  std::array<Part, 4 + 2 * kMostInside> parts_;
  std::size_t count_ = TriangleLattice::kPlaces;
  std::size_t part_count_ = 4;
};

}  // namespace softfinger
