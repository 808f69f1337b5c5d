#include "softfinger/device/mechanism/closed_linkage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfinger {
namespace {

// In units of rad, and of the linkage's length for what slides.
constexpr double kFarthestStart = 0.3;  // first correction that still counts as from nearby
// A step after which the next would be lost in rounding, and the derivatives change no more.
constexpr double kConverged = 1e-9;
constexpr double kLongestPiece = 0.5;           // motion between two solutions on a way
constexpr double kShortestPiece = 1.0 / 256.0;  // of the way
constexpr int kNewtonSteps = 8;
constexpr double kClosed = 1e-7;  // m; what equations that follow from the others may lack

/// Largest component of a step.
double size_of(const Linkage& linkage, const LinkageCoordinates& step) {
  double largest = 0.0;
  for (int j = 0; j < linkage.coordinate_count(); ++j) {
    const double size = std::abs(step[j]) / (linkage.is_angle(j) ? 1.0 : linkage.length());
    if (!(size <= largest)) largest = size;  // keeps NaN
  }
  return largest;
}

}  // namespace

ClosedLinkage::ClosedLinkage(Linkage linkage, std::vector<int> independent_equations)
    : linkage_(std::move(linkage)), independent_(std::move(independent_equations)) {
  for (int e = 0; e < linkage_.equation_count(); ++e) {
    if (std::find(independent_.begin(), independent_.end(), e) == independent_.end()) {
      dependent_.push_back(e);
    }
  }
}

void ClosedLinkage::derivatives(std::span<const LinkageReading> readings,
                                const LinkagePlacement& placement, LinkageMatrix& matrix) const {
  matrix.setZero(linkage_.coordinate_count(), linkage_.coordinate_count());
  int row = 0;
  for (const int e : independent_) linkage_.gradient(e, placement, matrix, row++);
  linkage_.gradients(readings, placement, matrix, row);
}

void ClosedLinkage::derivative_rates(std::span<const LinkageReading> readings,
                                     const LinkagePlacement& placement,
                                     const LinkageVelocity& velocity,
                                     const LinkageCoordinates& weights,
                                     LinkageMatrix& matrix) const {
  matrix.setZero(linkage_.coordinate_count(), linkage_.coordinate_count());
  int row = 0;
  for (const int e : independent_) {
    if (weights[row] != 0.0) linkage_.gradient_rate(e, placement, velocity, matrix, row);
    ++row;
  }
  linkage_.gradient_rates(readings, placement, velocity, matrix, row);
}

void ClosedLinkage::fill_sensitivity(int readings, LinkageSolution& solution) const {
  solution.determinant = solution.lu.determinant();
  solution.by_value.setZero(linkage_.coordinate_count(), readings);
  for (int k = 0; k < readings; ++k) {
    solution.by_value(static_cast<Eigen::Index>(independent_.size()) + k, k) = 1.0;
    solution.lu.solve(solution.by_value.col(k));
  }
}

bool ClosedLinkage::complete(std::span<const LinkageReading> readings,
                             LinkageSolution& solution) const {
  linkage_.place(solution.x, solution.placement);
  LinkageMatrix matrix;
  derivatives(readings, solution.placement, matrix);
  if (!solution.lu.factor(matrix)) return false;
  const auto count = static_cast<int>(readings.size());
  solution.values.resize(count);
  linkage_.read(readings, solution.x, solution.placement, solution.values);
  fill_sensitivity(count, solution);
  return true;
}

bool ClosedLinkage::close(std::span<const LinkageReading> readings,
                          LinkageSolution& solution) const {
  const auto count = static_cast<int>(readings.size());
  LinkageMatrix matrix;
  LinkageCoordinates step(linkage_.coordinate_count());
  double last = kFarthestStart;
  for (int iteration = 0; iteration < kNewtonSteps; ++iteration) {
    linkage_.place(solution.x, solution.placement);
    Eigen::Index row = 0;
    for (const int e : independent_) step[row++] = -linkage_.residual(e, solution.placement);
    linkage_.read(readings, solution.x, solution.placement, step.tail(count));
    step.tail(count) = solution.values - step.tail(count);
    derivatives(readings, solution.placement, matrix);
    if (!solution.lu.factor(matrix)) return false;
    solution.lu.solve(step);
    const double size = size_of(linkage_, step);
    if (!(size <= last)) return false;
    linkage_.move(solution.x, step);
    if (size < kConverged) {
      linkage_.place(solution.x, solution.placement);
      fill_sensitivity(count, solution);
      return std::all_of(dependent_.begin(), dependent_.end(), [&](int e) {
        return std::abs(linkage_.residual(e, solution.placement)) < kClosed;
      });
    }
    last = 0.5 * size;
  }
  return false;
}

bool ClosedLinkage::follow(std::span<const LinkageReading> readings, const LinkageInputs& values,
                           LinkageSolution& solution) const {
  const LinkageInputs start = solution.values;
  const double side = solution.determinant;
  LinkageSolution next;
  double at = 0.0;
  double piece = 1.0;
  while (at < 1.0) {
    // The last piece ends at the values themselves, to the last bit.
    const bool last = at + piece >= 1.0;
    next.values = last ? values : LinkageInputs(start + (at + piece) * (values - start));
    const LinkageCoordinates step = solution.by_value * (next.values - solution.values);
    next.x = solution.x;
    bool reached = size_of(linkage_, step) <= kLongestPiece;
    if (reached) {
      linkage_.move(next.x, step);
      reached = close(readings, next) && next.determinant * side > 0.0;
    }
    if (!reached) {
      piece *= 0.25;
      if (!(piece >= kShortestPiece)) return false;
      continue;
    }
    solution = next;  // copies what is used; a swap would take all that has room
    at = last ? 1.0 : at + piece;
  }
  return true;
}

}  // namespace softfinger
