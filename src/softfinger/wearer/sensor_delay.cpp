#include "softfinger/wearer/sensor_delay.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <utility>

namespace softfinger {
namespace {

constexpr double kMostDelay = 4.0;   // ticks
constexpr int kRefinements = 4;      // for a delay, by which what is felt is known later
constexpr double kLeastForce = 0.1;  // N, of a press that tells anything
constexpr std::size_t kLeastOfParabola = 5;

}  // namespace

void SensorDelay::leave(std::span<const Seen> press, double speed) {
  fall_ = {};
  if (press.size() < kLeastOfParabola) return;
  fall_.from = press.back().advance;
  fall_.touch = press.front().advance;
  fall_.speed = speed;
  const double unit = std::max(fall_.from - fall_.touch, 1e-6);
  const auto rows = static_cast<Eigen::Index>(press.size());
  Eigen::MatrixX3d powers(rows, 3);
  Eigen::VectorXd forces(rows);
  for (std::size_t i = 0; i < press.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double way = (press[i].advance - fall_.from) / unit;
    powers.row(row) << 1.0, way, way * way;
    forces[row] = press[i].force;
  }
  const Eigen::Vector3d found = powers.colPivHouseholderQr().solve(forces);
  fall_.force = {found[0], found[1] / unit, found[2] / (unit * unit)};
}

/// Before the touch was noticed, and where the parabola has passed zero, nothing.
double SensorDelay::Fall::felt(double advance, double late) const {
  const double way = advance + speed * late - from;
  const double slope = force[1] + 2.0 * force[2] * way;
  if (advance < touch || !(slope > 0.0)) return 0.0;
  return std::max(force[0] + way * (force[1] + way * force[2]), 0.0);
}

void SensorDelay::watch(double advance, double said) {
  if (fall_.force[0] > kLeastForce && fall_.force[1] > 0.0) fall_.after.push_back({advance, said});
}

void SensorDelay::keep() {
  if (!fall_.after.empty()) falls_.push_back(std::move(fall_));
  fall_ = {};
}

double SensorDelay::delay_of(const Fall& fall, double zero, double tick) const {
  double delay = 0.0;
  for (int look = 0; look < kRefinements; ++look) {
    double beyond = 0.0;
    for (const Seen& said : fall.after) {
      beyond += said.force - zero - fall.felt(said.advance, delay);
    }
    const double from = std::max(fall.felt(fall.from, delay), kLeastForce);
    delay = std::clamp(beyond / from, 0.0, kMostDelay) * tick;
  }
  return delay;
}

double SensorDelay::mean(double zero, double tick) const {
  if (falls_.empty()) return 0.0;
  std::vector<double> delays;
  for (const Fall& fall : falls_) delays.push_back(delay_of(fall, zero, tick));
  std::ranges::sort(delays);
  const std::size_t aside = delays.size() > 2 ? 1 : 0;
  const auto kept = std::span(delays).subspan(aside, delays.size() - 2 * aside);
  return std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size());
}

void take_delay_off(double delay, std::vector<PressRecord>& presses) {
  for (PressRecord& press : presses) {
    std::vector<PressReading>& readings = press.readings;
    Configuration way = readings[1].q - readings[0].q;  // of the first as of the second
    Configuration before = readings[0].q;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const std::size_t k = std::max<std::size_t>(i, 1);
      if (i > 0) way = readings[i].q - before;
      before = readings[i].q;
      readings[i].q -= way * (delay / (readings[k].time - readings[k - 1].time));
    }
  }
}

}  // namespace softfinger
