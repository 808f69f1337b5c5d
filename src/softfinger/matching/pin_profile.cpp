#include "softfinger/matching/pin_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

constexpr double kSameValue = 1e-17;  // m^2; least values nearer than this are not told apart
constexpr int kRimParts = 4;
constexpr int kHalvings = 30;  // of an interval with rim pieces, to under a nanometre

}  // namespace

PinProfile::PinProfile(int capacity) {
  const auto size = static_cast<std::size_t>(capacity);
  events_.reserve(3 * size);
  rims_.reserve(size);
  open_rims_.reserve(size);
}

void PinProfile::clear() {
  events_.clear();
  rims_.clear();
  open_rims_.clear();
  square_ = 0.0;
  linear_ = 0.0;
  constant_ = 0.0;
}

void PinProfile::add_event(double height, double square, double linear, double constant, int rim) {
  events_.push_back({height, square, linear, constant, rim});
}

void PinProfile::add_contact(double weight, double z, double offset2, double ceiling) {
  if (!(ceiling > offset2)) return;  // never the nearest: a constant
  const double constant = weight * (offset2 + z * z);
  if (!std::isfinite(ceiling)) {
    square_ += weight;
    linear_ += weight * z;
    constant_ += constant;
    return;
  }
  const double reach = std::sqrt(ceiling - offset2);
  constant_ += weight * ceiling;
  add_event(z - reach, weight, weight * z, constant - weight * ceiling);
  add_event(z + reach, -weight, -weight * z, weight * ceiling - constant);
}

void PinProfile::add_clear(double weight, double z, double beyond, double margin, double floor) {
  const double most = margin - beyond;  // lack once the pin's end has passed the sample
  constant_ += weight * floor * floor;
  if (!(most > floor)) return;
  if (beyond <= 0.0) {
    // Lack h - (z - margin), from where it passes the floor until the flank is nearer.
    const double zero = z - margin;
    add_event(zero + floor, weight, weight * zero, weight * (zero * zero - floor * floor));
    add_event(zero + most, -weight, -weight * zero, weight * (most * most - zero * zero));
    return;
  }
  const double distance = margin - floor;
  const double begin = z - std::sqrt(std::max(0.0, distance * distance - beyond * beyond));
  rims_.push_back({weight, z, beyond, margin});
  const int rim = static_cast<int>(rims_.size());
  add_event(begin, 0.0, 0.0, -weight * floor * floor, rim);
  add_event(z, 0.0, 0.0, weight * most * most, -rim);
}

double PinProfile::Rim::value(double h) const {
  const double lack = margin - std::sqrt(beyond * beyond + (z - h) * (z - h));
  return lack > 0.0 ? weight * lack * lack : 0.0;
}

double PinProfile::Rim::slope(double h) const {
  const double distance = std::sqrt(beyond * beyond + (z - h) * (z - h));
  const double lack = margin - distance;
  return lack > 0.0 ? 2.0 * weight * lack * (z - h) / distance : 0.0;
}

double PinProfile::value(double h) const {
  double sum = (square_ * h - 2.0 * linear_) * h + constant_;
  for (const int rim : open_rims_) sum += rims_[static_cast<std::size_t>(rim)].value(h);
  return sum;
}

/// Least in an interval without events; the lower end's where there are several.
double PinProfile::inner_minimum(double from, double to) const {
  if (open_rims_.empty()) return std::clamp(linear_ / square_, from, to);
  const auto slope = [&](double h) {
    double sum = 2.0 * (square_ * h - linear_);
    for (const int rim : open_rims_) sum += rims_[static_cast<std::size_t>(rim)].slope(h);
    return sum;
  };
  if (slope(from) >= 0.0) return from;
  if (slope(to) <= 0.0) return to;
  for (int i = 0; i < kHalvings && to - from > 1e-10; ++i) {
    const double middle = 0.5 * (from + to);
    (slope(middle) < 0.0 ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

double PinProfile::minimise(double low, double high, double home) {
  std::sort(events_.begin(), events_.end(),
            [](const Event& a, const Event& b) { return a.height < b.height; });
  const double rest = std::clamp(home, low, high);
  double best = rest;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](double h) {
    const double at = value(h);
    const double slack = std::isfinite(least) ? kSameValue + 1e-9 * std::abs(least) : 0.0;
    if (at < least - slack || (at <= least + slack && std::abs(h - rest) < std::abs(best - rest))) {
      least = std::min(at, least);
      best = h;
    }
  };
  double from = low;
  std::size_t next = 0;
  for (;;) {
    for (; next < events_.size() && events_[next].height <= from; ++next) {
      const Event& event = events_[next];
      square_ += event.square;
      linear_ += event.linear;
      constant_ += event.constant;
      if (event.rim > 0) open_rims_.push_back(event.rim - 1);
      if (event.rim < 0) std::erase(open_rims_, -event.rim - 1);
    }
    const double to = next < events_.size() ? std::min(events_[next].height, high) : high;
    const bool curved = square_ > 1e-9 || !open_rims_.empty();
    if (!curved) {
      consider(std::clamp(rest, from, to));
    } else {
      // Rim pieces are not convex: the interval is searched in parts.
      const int parts = open_rims_.empty() ? 1 : kRimParts;
      const double length = (to - from) / parts;
      for (int i = 0; i < parts; ++i) {
        consider(inner_minimum(from + i * length, from + (i + 1) * length));
      }
    }
    if (to >= high) return best;
    from = to;
  }
}

}  // namespace softfinger
