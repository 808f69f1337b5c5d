#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "live_faults.hpp"

namespace softfinger {

/// What a live run came to under a fault.
struct LiveOutcome {
  double rate = 0.0;                             ///< steps a second, Hz
  std::vector<double> lateness;                  ///< of each step, s
  std::vector<double> step_time;                 ///< wall time of each recorded step, s
  std::optional<std::uint64_t> deadline_misses;  ///< none where the run ended with an error
  std::int64_t steps = 0;
  std::int64_t recorded = 0;
  std::int64_t missing =
      0;  ///< steps that should be recorded: where the disk fills, to 0.2 s before
  /// No servo was farther from its command for nine tenths of the last second, rad; none where the
  /// commands of then are not recorded.
  std::optional<double> behind;
  double unretracted = 0.0;  ///< how far the servos ended from the retracted pose, rad
  /// How long it took until the servos stood retracted for good, s: since the run's last step, or
  /// the fault, where that stops the device; infinite: they did not.
  double retracted_in = 0.0;
  std::size_t held_back = 0;  ///< the most bytes that waited in the line
  int replayed = 0;           ///< how often a servo's target changed when those came
  std::vector<std::string> messages;
  long visitors = 0;
  long pictures = 0;             ///< that a page which watched all the time got
  double longest_gap = 0.0;      ///< s between two
  std::optional<double> stolen;  ///< share of the processors' time, see StolenTime
};

/// A live run of scenes/sphere.toml for `seconds`.
[[nodiscard]] LiveOutcome run_live(const LiveFault& fault, double seconds);

}  // namespace softfinger
