#pragma once

#include <cstdint>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/device/surfaces/pin_field.hpp"
#include "softfinger/matching/pin_profile.hpp"

namespace softfinger {

/// Minimises the contact surface deviation of a field of pins, one pin at a time and each exactly:
/// as a function of one height E is a sum of cut-off parabolas (a sample in contact follows the
/// nearest end until another pin's is nearer), whose least value is found in one sweep. Pins move
/// in turn until none gains; a pin is looked at again only when one that shares a sample has moved.
/// Pins that no sample can see stay where they are nearest home.
class PinMinimiser {
 public:
  struct Outcome {
    Configuration q;
    double deviation = 0.0;  ///< E, m^2
    int iterations = 0;      ///< rounds over the pins
    bool converged = false;
  };

  /// `capacity`: most samples.
  PinMinimiser(const Device& device, int capacity);

  /// Takes the samples of a solve and what pins each can see; `inside`: within the pins' strokes.
  void take(const SurfaceSamples& samples, bool inside);
  /// From the heights in `start`.
  [[nodiscard]] Outcome minimise(const Configuration& start, int iteration_limit);
  /// A start that needs none: each pin at the mean of the samples in contact that it is nearest to,
  /// seen along z.
  [[nodiscard]] Configuration assigned() const;

 private:
  /// That a pin and a sample see each other.
  struct Sight {
    int pin = 0, sample = 0;
    double beyond = 0.0;  ///< of the sample to the pin's flank, m
  };
  /// A sample of the solve, in B'.
  struct Seen {
    double z = 0.0, weight = 0.0, margin = 0.0;
    bool touching = false;
    int first = 0, last = 0;  ///< its sights
    int pin = -1;             ///< the nearest, at the present heights
    double nearest = 0.0;     ///< distance to it (squared for samples in contact), m or m^2
    double second = 0.0;      ///< to the next
  };

  [[nodiscard]] double distance(const Sight& sight, double height) const;
  void look(Seen& sample) const;
  [[nodiscard]] double best_height(int pin);
  [[nodiscard]] double total() const;

  const Device& device_;
  const PinField& field_;
  std::vector<Sight> by_sample_;
  std::vector<int> by_pin_, pin_first_;  ///< sights of pin k: by_pin_[pin_first_[k]...]
  std::vector<Seen> samples_;
  std::vector<std::uint8_t> waiting_;  ///< per pin: to be looked at
  PinProfile profile_;
  Configuration q_, low_, high_;
};

}  // namespace softfinger
