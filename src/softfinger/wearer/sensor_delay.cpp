#include "softfinger/wearer/sensor_delay.hpp"

#include <algorithm>
#include <numeric>
#include <span>

namespace softfinger {
namespace {

constexpr double kMostDelay = 4.0;  // ticks

}  // namespace

void SensorDelay::leave(double force, double slope, double advance, double speed) {
  fall_ = {.force = force, .slope = slope, .from = advance, .speed = speed};
}

void SensorDelay::watch(double advance, double said) {
  if (!(fall_.force > 0.0)) return;
  const double back = fall_.from - advance;
  fall_.beyond += said - std::max(fall_.force - fall_.slope * back, 0.0);
  fall_.readings += 1.0;
}

void SensorDelay::keep() {
  if (fall_.force > 0.0) falls_.push_back(fall_);
  fall_ = {};
}

/// The last force said was late as well: by then more was felt.
double SensorDelay::ticks_of(const Fall& fall, double zero, double tick) {
  const double beyond = fall.beyond - fall.readings * zero;
  const double a_tick = fall.slope * fall.speed * tick;  // of growth, N
  double ticks = 0.0;
  for (int i = 0; i < 3; ++i) ticks = beyond / (fall.force + a_tick * std::max(ticks, 0.0));
  return ticks;
}

double SensorDelay::mean(double zero, double tick) const {
  if (falls_.empty()) return 0.0;
  std::vector<double> delays;
  for (const Fall& fall : falls_) delays.push_back(ticks_of(fall, zero, tick));
  std::ranges::sort(delays);
  const std::size_t aside = delays.size() > 2 ? 1 : 0;
  const auto kept = std::span(delays).subspan(aside, delays.size() - 2 * aside);
  const double mean =
      std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size());
  return std::clamp(mean, 0.0, kMostDelay) * tick;
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
