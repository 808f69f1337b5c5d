#include "softfinger/matching/pin_minimiser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMoved = 1e-10;  // m; a pin that moves less stands still

}  // namespace

PinMinimiser::PinMinimiser(const Device& device, int capacity)
    : device_(device),
      field_(*device.pin_field()),
      profile_(capacity),
      q_(device.home()),
      low_(device.home()),
      high_(device.home()) {
  const auto pins = static_cast<std::size_t>(field_.count());
  by_sample_.reserve(pins * static_cast<std::size_t>(capacity));
  by_pin_.reserve(by_sample_.capacity());
  pin_first_.resize(pins + 1);
  waiting_.resize(pins);
  samples_.reserve(static_cast<std::size_t>(capacity));
}

void PinMinimiser::take(const SurfaceSamples& samples, bool inside) {
  samples_.clear();
  by_sample_.clear();
  const Configuration& home = device_.home();
  double lowest = home.minCoeff();
  double highest = home.maxCoeff();
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const double z = field_.in_mount({samples.x[s], samples.y[s], samples.z[s]}).z();
    lowest = std::min(lowest, z - samples.margin[s]);
    highest = std::max(highest, z);
  }
  for (int k = 0; k < field_.count(); ++k) {
    const ConfigurationAxis& axis = device_.axes()[static_cast<std::size_t>(k)];
    // No pin gains by going below or above all samples and home.
    low_[k] = inside ? axis.min : lowest;
    high_[k] = inside ? axis.max : highest;
  }
  lowest = low_.minCoeff();
  highest = high_.maxCoeff();

  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = field_.in_mount({samples.x[s], samples.y[s], samples.z[s]});
    Seen seen;
    seen.z = p_B.z();
    seen.weight = samples.weight[s];
    seen.margin = samples.margin[s];
    seen.touching = i < samples.contact_count;
    seen.first = static_cast<int>(by_sample_.size());
    if (seen.touching) {
      // Further aside than this no pin is the nearest, whatever the heights.
      const double near = std::max({0.0, lowest - p_B.z(), p_B.z() - highest});
      const double far = std::max(std::abs(p_B.z() - lowest), std::abs(p_B.z() - highest));
      double least = kInfinity;
      const auto reach = [&] {
        return std::isfinite(least) ? std::sqrt(least * least + far * far - near * near) : least;
      };
      field_.around(p_B.x(), p_B.y(), reach, [&](int pin, double beyond) {
        least = std::min(least, std::max(0.0, beyond));
        by_sample_.push_back({pin, i, beyond});
      });
      const double limit = reach();
      const auto begin = by_sample_.begin() + seen.first;
      by_sample_.erase(std::remove_if(begin, by_sample_.end(),
                                      [&](const Sight& sight) { return sight.beyond > limit; }),
                       by_sample_.end());
    } else if (p_B.z() - seen.margin < highest) {
      const double margin = seen.margin;
      field_.around(
          p_B.x(), p_B.y(), [margin] { return margin; },
          [&](int pin, double beyond) {
            if (beyond < margin) by_sample_.push_back({pin, i, beyond});
          });
    }
    seen.last = static_cast<int>(by_sample_.size());
    samples_.push_back(seen);
  }

  // The same by pin, by counting.
  std::fill(pin_first_.begin(), pin_first_.end(), 0);
  for (const Sight& sight : by_sample_) ++pin_first_[static_cast<std::size_t>(sight.pin) + 1];
  for (std::size_t k = 1; k < pin_first_.size(); ++k) pin_first_[k] += pin_first_[k - 1];
  by_pin_.resize(by_sample_.size());
  for (std::size_t at = by_sample_.size(); at-- > 0;) {
    int& end = pin_first_[static_cast<std::size_t>(by_sample_[at].pin) + 1];
    by_pin_[static_cast<std::size_t>(--end)] = static_cast<int>(at);
  }
  // Ends have become beginnings: shift them back by one.
  for (std::size_t k = 0; k + 1 < pin_first_.size(); ++k) pin_first_[k] = pin_first_[k + 1];
  pin_first_.back() = static_cast<int>(by_sample_.size());
}

/// Squared for a sample in contact, signed for one that is not.
double PinMinimiser::distance(const Sight& sight, double height) const {
  const Seen& sample = samples_[static_cast<std::size_t>(sight.sample)];
  const double above = sample.z - height;
  if (!sample.touching) return pin_distance(sight.beyond, above).distance;
  const double aside = std::max(0.0, sight.beyond);
  return aside * aside + above * above;
}

/// The two nearest pins of a sample.
void PinMinimiser::look(Seen& sample) const {
  sample.pin = -1;
  sample.nearest = kInfinity;
  sample.second = kInfinity;
  for (int at = sample.first; at < sample.last; ++at) {
    const Sight& sight = by_sample_[static_cast<std::size_t>(at)];
    const double here = distance(sight, q_[sight.pin]);
    if (here < sample.nearest) {
      sample.second = sample.nearest;
      sample.nearest = here;
      sample.pin = sight.pin;
    } else {
      sample.second = std::min(sample.second, here);
    }
  }
}

double PinMinimiser::best_height(int pin) {
  profile_.clear();
  const auto k = static_cast<std::size_t>(pin);
  for (int at = pin_first_[k]; at < pin_first_[k + 1]; ++at) {
    const Sight& sight =
        by_sample_[static_cast<std::size_t>(by_pin_[static_cast<std::size_t>(at)])];
    const Seen& sample = samples_[static_cast<std::size_t>(sight.sample)];
    const double others = sample.pin == pin ? sample.second : sample.nearest;
    if (sample.touching) {
      const double aside = std::max(0.0, sight.beyond);
      profile_.add_contact(sample.weight, sample.z, aside * aside, others);
    } else {
      profile_.add_clear(sample.weight, sample.z, sight.beyond, sample.margin,
                         std::max(0.0, sample.margin - others));
    }
  }
  return profile_.minimise(low_[pin], high_[pin], device_.home()[pin]);
}

double PinMinimiser::total() const {
  double sum = 0.0;
  for (const Seen& sample : samples_) {
    if (sample.touching) {
      sum += sample.weight * sample.nearest;
    } else {
      const double lack = std::max(0.0, sample.margin - sample.nearest);
      sum += sample.weight * lack * lack;
    }
  }
  return sum;
}

PinMinimiser::Outcome PinMinimiser::minimise(const Configuration& start, int iteration_limit) {
  q_ = start.cwiseMax(low_).cwiseMin(high_);
  for (Seen& sample : samples_) look(sample);
  std::fill(waiting_.begin(), waiting_.end(), std::uint8_t{1});
  Outcome outcome;
  for (bool moved = true; moved && outcome.iterations < iteration_limit; ++outcome.iterations) {
    moved = false;
    for (int pin = 0; pin < field_.count(); ++pin) {
      const auto k = static_cast<std::size_t>(pin);
      if (waiting_[k] == 0) continue;
      waiting_[k] = 0;
      const double height = best_height(pin);
      const bool stays = std::abs(height - q_[pin]) < kMoved;
      q_[pin] = height;
      if (stays) continue;
      moved = true;
      for (int at = pin_first_[k]; at < pin_first_[k + 1]; ++at) {
        const auto sight = static_cast<std::size_t>(by_pin_[static_cast<std::size_t>(at)]);
        Seen& sample = samples_[static_cast<std::size_t>(by_sample_[sight].sample)];
        look(sample);
        for (int other = sample.first; other < sample.last; ++other) {
          waiting_[static_cast<std::size_t>(by_sample_[static_cast<std::size_t>(other)].pin)] = 1;
        }
      }
      waiting_[k] = 0;
    }
    outcome.converged = !moved;
  }
  outcome.q = q_;
  outcome.deviation = total();
  return outcome;
}

Configuration PinMinimiser::assigned() const {
  Configuration q = device_.home();
  Configuration weight = Configuration::Zero(q.size());
  Configuration sum = Configuration::Zero(q.size());
  for (const Seen& sample : samples_) {
    if (!sample.touching) continue;
    const auto begin = by_sample_.begin() + sample.first;
    const auto nearest =
        std::min_element(begin, by_sample_.begin() + sample.last,
                         [](const Sight& a, const Sight& b) { return a.beyond < b.beyond; });
    weight[nearest->pin] += sample.weight;
    sum[nearest->pin] += sample.weight * sample.z;
  }
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    if (weight[k] > 0.0) q[k] = sum[k] / weight[k];
  }
  return q;
}

}  // namespace softfinger
