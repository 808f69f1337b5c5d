#include "softfinger/wearer/press_relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kLeastTime = 1e-4;  // s, between readings
/// Of the skin under one press of a fit, what is about under the next, which is turned.
constexpr double kShared = 0.6;

/// Skin under one force. What relaxes of it is each term's g m, where m follows the force that
/// there would be without, within tau.
class Skin {
 public:
  explicit Skin(const Relaxation& relaxation)
      : terms_(relaxation.terms), follows_(relaxation.terms.size(), 0.0) {}

  /// It is touched again after a time on its own.
  void recover(double time) {
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      follows_[k] *= kShared * std::exp(-std::max(time - time_, 0.0) / terms_[k].time);
    }
    force_ = 0.0;
    time_ = time;
  }

  /// The force without relaxation where `felt` is, which has grown evenly since the last.
  double pressed(double time, double felt) {
    const double elapsed = std::max(time - time_, kLeastTime);
    double of_force = 1.0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto& [fraction, tau] = terms_[k];
      const double decay = std::exp(-elapsed / tau);
      const double behind = tau / elapsed * (1.0 - decay);  // of what has grown
      follows_[k] = decay * follows_[k] + (behind - decay) * force_;
      felt += fraction * follows_[k];
      of_force -= fraction * (1.0 - behind);
    }
    force_ = felt / of_force;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const double decay = std::exp(-elapsed / terms_[k].time);
      follows_[k] += (1.0 - terms_[k].time / elapsed * (1.0 - decay)) * force_;
    }
    time_ = time;
    return force_;
  }

 private:
  const std::vector<Relaxation::Term>& terms_;
  std::vector<double> follows_;  ///< by term, N
  double force_ = 0.0;           ///< without relaxation, N
  double time_ = 0.0;            ///< s, of that
};

}  // namespace

double stress_of_growing_force(const Relaxation& relaxation, double rate) {
  double left = 1.0;
  for (const Relaxation::Term& term : relaxation.terms) {
    left -= term.fraction / (1.0 + rate * term.time);
  }
  return left;
}

double stiffness_in_use(const FingerModel& finger, double speed) {
  return 1.0 / stress_of_growing_force(finger.relaxation, kForceGrowth * speed);
}

std::vector<PressRecord> without_relaxation(std::vector<PressRecord> presses,
                                            const Relaxation& relaxation) {
  Skin skin(relaxation);
  for (PressRecord& press : presses) {
    const auto& first = press.approach.empty() ? press.readings : press.approach;
    if (first.empty()) continue;
    skin.recover(first.front().time);
    for (const PressReading& reading : press.approach) {
      skin.pressed(reading.time, reading.force);
    }
    for (PressReading& reading : press.readings) {
      reading.force = skin.pressed(reading.time, reading.force);
    }
  }
  return presses;
}

}  // namespace softfinger
