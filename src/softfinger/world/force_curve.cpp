#include "softfinger/world/force_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

/// Slope at an end by its two nearest chords of these lengths and slopes; of the first's sign.
double end_slope(double near_length, double far_length, double near, double far) {
  const double slope =
      ((2.0 * near_length + far_length) * near - near_length * far) / (near_length + far_length);
  if (slope * near <= 0.0) return 0.0;
  if (near * far < 0.0 && std::abs(slope) > 3.0 * std::abs(near)) return 3.0 * near;
  return slope;
}

/// Slope between two chords: their weighted harmonic mean, none at an extremum.
double middle_slope(double left_length, double right_length, double left, double right) {
  if (left * right <= 0.0) return 0.0;
  const double by_left = 2.0 * right_length + left_length;
  const double by_right = right_length + 2.0 * left_length;
  return (by_left + by_right) / (by_left / left + by_right / right);
}

std::vector<double> slopes_of(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t chords = x.size() - 1;
  std::vector<double> length(chords), chord(chords);
  for (std::size_t i = 0; i < chords; ++i) {
    length[i] = x[i + 1] - x[i];
    chord[i] = (y[i + 1] - y[i]) / length[i];
  }
  if (chords == 1) return {chord[0], chord[0]};
  std::vector<double> slopes(x.size());
  slopes.front() = end_slope(length[0], length[1], chord[0], chord[1]);
  for (std::size_t i = 1; i < chords; ++i) {
    slopes[i] = middle_slope(length[i - 1], length[i], chord[i - 1], chord[i]);
  }
  const std::size_t last = chords - 1;
  slopes.back() = end_slope(length[last], length[last - 1], chord[last], chord[last - 1]);
  return slopes;
}

std::vector<ForceCurve::Snap> snaps_of(const JointCurve& points) {
  std::vector<ForceCurve::Snap> snaps;
  bool rises = false;  // of late; a level part changes nothing
  bool falls = false;
  for (std::size_t i = 1; i < points.force.size(); ++i) {
    const double change = points.force[i] - points.force[i - 1];
    if (change < 0.0 && rises) {
      snaps.push_back({points.travel[i - 1], std::numeric_limits<double>::infinity()});
    }
    if (change > 0.0 && falls && !snaps.empty()) snaps.back().valley = points.travel[i - 1];
    if (change == 0.0) continue;
    rises = change > 0.0;
    falls = !rises;
  }
  return snaps;
}

}  // namespace

ForceCurve::Value ForceCurve::Piece::at(double travel) const {
  const double s = travel - start;
  return {work + s * (force + s * (slope / 2.0 + s * (second / 3.0 + s * third / 4.0))),
          force + s * (slope + s * (second + s * third)),
          slope + s * (2.0 * second + s * 3.0 * third)};
}

ForceCurve::ForceCurve(const JointCurve& points)
    : travel_(points.travel), snaps_(snaps_of(points)) {
  const std::vector<double> slopes = slopes_of(points.travel, points.force);
  pieces_.push_back(
      {.start = travel_.front(), .force = points.force.front(), .slope = slopes.front()});
  double work = 0.0;
  for (std::size_t i = 0; i + 1 < travel_.size(); ++i) {
    const double length = travel_[i + 1] - travel_[i];
    const double chord = (points.force[i + 1] - points.force[i]) / length;
    pieces_.push_back({.start = travel_[i],
                       .work = work,
                       .force = points.force[i],
                       .slope = slopes[i],
                       .second = (3.0 * chord - 2.0 * slopes[i] - slopes[i + 1]) / length,
                       .third = (slopes[i] + slopes[i + 1] - 2.0 * chord) / (length * length)});
    work = pieces_.back().at(travel_[i + 1]).work;
  }
  pieces_.push_back({.start = travel_.back(),
                     .work = work,
                     .force = points.force.back(),
                     .slope = slopes.back()});
  const double at_zero = at(0.0).work;
  for (Piece& piece : pieces_) piece.work -= at_zero;
}

ForceCurve::Value ForceCurve::at(double travel) const {
  const auto piece = std::ranges::upper_bound(travel_, travel) - travel_.begin();
  return pieces_[static_cast<std::size_t>(piece)].at(travel);
}

double ForceCurve::least_slope(double from, double to) const {
  // Beyond its points slopes are those of its ends.
  from = std::clamp(from, travel_.front(), travel_.back());
  to = std::clamp(to, travel_.front(), travel_.back());
  double least = std::min(at(from).slope, at(to).slope);
  const auto look = [&](double travel) {
    if (travel > from && travel < to) least = std::min(least, at(travel).slope);
  };
  for (std::size_t i = 0; i < travel_.size(); ++i) {
    look(travel_[i]);
    const Piece& piece = pieces_[i + 1];
    if (piece.third > 0.0) {  // the slope is a parabola that opens upwards
      const double lowest = piece.start - piece.second / (3.0 * piece.third);
      if (lowest > piece.start && i + 1 < travel_.size() && lowest < travel_[i + 1]) look(lowest);
    }
  }
  return least;
}

}  // namespace softfinger
