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

using Weights = std::array<double, 3>;

/// A side of a triangle of the skin is looked at in so many parts.
constexpr int kParts = 2;
/// Places in a triangle where it is looked at: its corners, and all others a part apart.
constexpr int kPlaces = (kParts + 1) * (kParts + 2) / 2;
/// Features in one triangle that it is divided at besides.
constexpr std::size_t kMostInside = 4;
/// Triangles without a corner nearer than this part of their longest side touch nowhere: so much
/// is a side bent whose ends face directions 70 degrees apart.
constexpr double kReach = 0.15;
/// What an obstacle may come nearer inside a triangle than its tangent planes at the corners tell,
/// where it is hollow, m.
constexpr double kHollow = 5e-5;

using Part = std::array<std::size_t, 3>;

/// The places, and the triangles between them.
struct Lattice {
  std::array<Weights, kPlaces> weights;
  Eigen::Matrix<double, CurvedTriangle::kControlPoints, kPlaces> basis;
  std::array<int, kPlaces> corner;   ///< that the place is; -1: none
  std::array<int, kPlaces> nearest;  ///< corner
  std::array<Part, kParts * kParts> parts;

  Lattice() {
    std::array<std::array<std::size_t, kParts + 1>, kParts + 1> at{};
    std::size_t count = 0;
    for (std::size_t i = 0; i <= kParts; ++i) {
      for (std::size_t j = 0; i + j <= kParts; ++j) {
        at[i][j] = count;
        const double a = static_cast<double>(i) / kParts, b = static_cast<double>(j) / kParts;
        add(count++, {a, b, static_cast<double>(kParts - i - j) / kParts});
      }
    }
    count = 0;
    for (std::size_t i = 0; i < kParts; ++i) {
      for (std::size_t j = 0; i + j < kParts; ++j) {
        parts[count++] = {at[i][j], at[i + 1][j], at[i][j + 1]};
        if (i + j + 1 < kParts) parts[count++] = {at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]};
      }
    }
  }

 private:
  void add(std::size_t place, const Weights& of) {
    weights[place] = of;
    basis.col(static_cast<Eigen::Index>(place)) = CurvedTriangle::basis(of);
    const auto greatest = std::max_element(of.begin(), of.end());
    nearest[place] = static_cast<int>(greatest - of.begin());
    corner[place] = *greatest == 1.0 ? nearest[place] : -1;
  }
};

const Lattice& lattice() {
  static const Lattice kLattice;
  return kLattice;
}

/// A place on the skin, and by how much it is out of contact (m, negative within).
struct Place {
  Vector3 position_F = Vector3::Zero();
  double excess = 0.0;
};

/// Part of a triangle where a linear function with these values at its corners is at most 0.
double part_below_zero(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  if (c <= 0.0) return 1.0;
  if (a >= 0.0) return 0.0;
  return b >= 0.0 ? a * a / ((a - b) * (a - c)) : 1.0 - c * c / ((c - a) * (c - b));
}

double area_within(const Place& a, const Place& b, const Place& c) {
  const double part = part_below_zero(a.excess, b.excess, c.excess);
  if (part <= 0.0) return 0.0;
  return 0.5 * part * (b.position_F - a.position_F).cross(c.position_F - a.position_F).norm();
}

/// A triangle of the skin, divided at its places, and further at features.
class DividedTriangle {
 public:
  std::array<Place, kPlaces + kMostInside> places;

  [[nodiscard]] double area_within() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < part_count_; ++k) {
      const auto& [a, b, c] = parts_[k];
      sum += softfinger::area_within(places[a], places[b], places[c]);
    }
    return sum;
  }
  /// One more place divides the part that it is in.
  void divide_at(const Weights& weights, const Place& place) {
    if (count_ == places.size()) return;
    for (std::size_t k = 0; k < part_count_; ++k) {
      const Part part = parts_[k];
      if (!holds(part, weights)) continue;
      places[count_] = place;
      weights_[count_] = weights;
      parts_[k] = {part[0], part[1], count_};
      parts_[part_count_++] = {part[1], part[2], count_};
      parts_[part_count_++] = {part[2], part[0], count_};
      ++count_;
      return;
    }
  }
  DividedTriangle() {
    std::copy(lattice().weights.begin(), lattice().weights.end(), weights_.begin());
    std::copy(lattice().parts.begin(), lattice().parts.end(), parts_.begin());
  }

 private:
  [[nodiscard]] bool holds(const Part& part, const Weights& p) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Weights& a = weights_[part[k]];
      const Weights& b = weights_[part[(k + 1) % 3]];
      if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0.0) return false;
    }
    return true;
  }
  std::array<Weights, kPlaces + kMostInside> weights_;
  std::array<Part, kParts * kParts + 2 * kMostInside> parts_;
  std::size_t count_ = kPlaces;
  std::size_t part_count_ = kParts * kParts;
};

/// A triangle of the skin in contact.
class SkinTriangle {
 public:
  SkinTriangle(const SkinSurface& skin, const SettledContact& contact, const ContactSet& set,
               const std::array<int, 3>& samples)
      : skin_(skin), contact_(contact), set_(set), samples_(samples) {
    for (std::size_t k = 0; k < 3; ++k)
      corners_[k] = &set.samples[static_cast<std::size_t>(samples[k])];
  }

  [[nodiscard]] double area_in_contact() const {
    if (is_pressed()) return area();
    const bool has_feature =
        std::any_of(set_.features().begin(), set_.features().end(),
                    [this](const ContactFeature& feature) { return feature.samples == samples_; });
    if (!has_feature && !is_near()) return 0.0;
    const CurvedTriangle curved(
        {position(0), position(1), position(2)},
        {corners_[0]->skin_normal_F, corners_[1]->skin_normal_F, corners_[2]->skin_normal_F});
    if (has_feature) {
      DividedTriangle divided;
      look_at(curved, divided.places);
      for (const ContactFeature& feature : set_.features()) {
        if (feature.samples == samples_) divided.divide_at(feature.weights, place_of(feature));
      }
      return divided.area_within();
    }
    if (!may_touch(curved)) return 0.0;
    std::array<Place, kPlaces> places;
    look_at(curved, places);
    double sum = 0.0;
    for (const auto& [a, b, c] : lattice().parts)
      sum += area_within(places[a], places[b], places[c]);
    return sum;
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
  template <std::size_t n>
  void look_at(const CurvedTriangle& curved, std::array<Place, n>& places) const {
    const Eigen::Matrix<double, 3, kPlaces> positions = curved.control_points() * lattice().basis;
    // How much less the gap counts at the corners.
    Weights held;
    for (std::size_t k = 0; k < 3; ++k) {
      held[k] = punch_depth(corners_[k]->own_normal_force, corners_[k]->area, skin_.plane_modulus);
    }
    for (std::size_t k = 0; k < kPlaces; ++k) {
      Place& place = places[k];
      place.position_F = positions.col(static_cast<Eigen::Index>(k));
      const int corner = lattice().corner[k];
      const double gap = corner >= 0 ? corners_[static_cast<std::size_t>(corner)]->gap
                                     : gap_at(place.position_F, lattice().nearest[k]);
      const Weights& weights = lattice().weights[k];
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
      const Vector3 position_O = contact_.potential.obstacle_view(obstacle) * position_W;
      const auto sample = static_cast<std::size_t>(samples_[static_cast<std::size_t>(nearest)]);
      least = std::min(least, contact_.potential.look(sample, obstacle, position_O).distance);
    }
    return least;
  }
  [[nodiscard]] Place place_of(const ContactFeature& feature) const {
    const double depth =
        punch_depth(feature.normal_force_F.norm(), feature.area, skin_.plane_modulus);
    return {feature.position_F, feature.gap - depth - contact_.tolerance};
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

double area_in_contact(const SkinSurface& skin, const SettledContact& contact,
                       const ContactSet& set) {
  double sum = 0.0;
  for (const auto& samples : skin.triangles) {
    sum += SkinTriangle(skin, contact, set, samples).area_in_contact();
  }
  return sum;
}

}  // namespace softfinger
