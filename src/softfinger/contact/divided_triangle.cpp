#include "softfinger/contact/divided_triangle.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace softfinger {
namespace {

constexpr std::size_t kPartsOfSide = 2;

/// Part of a triangle where a linear function with these values at its corners is at most 0.
double part_below_zero(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  if (c <= 0.0) return 1.0;
  if (a >= 0.0) return 0.0;
  return b >= 0.0 ? a * a / ((a - b) * (a - c)) : 1.0 - c * c / ((c - a) * (c - b));
}

}  // namespace

TriangleLattice::TriangleLattice() {
  std::array<std::array<std::size_t, kPartsOfSide + 1>, kPartsOfSide + 1> at{};
  std::size_t count = 0;
  for (std::size_t i = 0; i <= kPartsOfSide; ++i) {
    for (std::size_t j = 0; i + j <= kPartsOfSide; ++j) {
      at[i][j] = count;
      const auto weight = [](std::size_t k) { return static_cast<double>(k) / kPartsOfSide; };
      add(count++, {weight(i), weight(j), weight(kPartsOfSide - i - j)});
    }
  }
  count = 0;
  for (std::size_t i = 0; i < kPartsOfSide; ++i) {
    for (std::size_t j = 0; i + j < kPartsOfSide; ++j) {
      parts[count++] = {at[i][j], at[i + 1][j], at[i][j + 1]};
      if (i + j + 1 < kPartsOfSide) parts[count++] = {at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]};
    }
  }
}

void TriangleLattice::add(std::size_t place, const Weights& of) {
  weights[place] = of;
  basis.col(static_cast<Eigen::Index>(place)) = CurvedTriangle::basis(of);
  const auto greatest = std::max_element(of.begin(), of.end());
  nearest[place] = static_cast<int>(greatest - of.begin());
  corner[place] = *greatest == 1.0 ? nearest[place] : -1;
}

const TriangleLattice& TriangleLattice::get() {
  static const TriangleLattice kLattice;
  return kLattice;
}

double area_within(const SkinPoint& a, const SkinPoint& b, const SkinPoint& c) {
  const double part = part_below_zero(a.excess, b.excess, c.excess);
  if (part <= 0.0) return 0.0;
  return 0.5 * part * (b.position_F - a.position_F).cross(c.position_F - a.position_F).norm();
}

DividedTriangle::DividedTriangle() {
  const TriangleLattice& lattice = TriangleLattice::get();
  std::copy(lattice.weights.begin(), lattice.weights.end(), weights_.begin());
  std::copy(lattice.parts.begin(), lattice.parts.end(), parts_.begin());
}

DividedTriangle::Weights DividedTriangle::weights_in(const Part& part, const Weights& p) const {
  const auto twice_area = [](const Weights& u, const Weights& v, const Weights& w) {
    return (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]);
  };
  const Weights &a = weights_[part[0]], &b = weights_[part[1]], &c = weights_[part[2]];
  const double whole = twice_area(a, b, c);
  if (!(whole > 0.0)) return {-1.0, -1.0, -1.0};  // divided at a place on its side
  return {twice_area(p, b, c) / whole, twice_area(a, p, c) / whole, twice_area(a, b, p) / whole};
}

void DividedTriangle::divide_at(const Weights& weights, const SkinPoint& place) {
  if (count_ == places.size()) return;
  for (std::size_t k = 0; k < part_count_; ++k) {
    const Part part = parts_[k];
    const Weights inside = weights_in(part, weights);
    if (*std::min_element(inside.begin(), inside.end()) < 0.0) continue;
    places[count_] = place;
    weights_[count_] = weights;
    parts_[k] = {part[0], part[1], count_};
    parts_[part_count_++] = {part[1], part[2], count_};
    parts_[part_count_++] = {part[2], part[0], count_};
    ++count_;
    return;
  }
}

double DividedTriangle::area_within() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < part_count_; ++k) {
    const auto& [a, b, c] = parts_[k];
    sum += softfinger::area_within(places[a], places[b], places[c]);
  }
  return sum;
}

double DividedTriangle::excess_at(const Weights& weights) const {
  // Of the part that has the place, or nearly: rounding may put it outside of all.
  double most_inside = -std::numeric_limits<double>::infinity();
  double excess = 0.0;
  for (std::size_t k = 0; k < part_count_; ++k) {
    const Weights inside = weights_in(parts_[k], weights);
    const double least = *std::min_element(inside.begin(), inside.end());
    if (least <= most_inside) continue;
    most_inside = least;
    excess = 0.0;
    for (std::size_t c = 0; c < 3; ++c) excess += inside[c] * places[parts_[k][c]].excess;
    if (least >= 0.0) break;
  }
  return excess;
}

}  // namespace softfinger
