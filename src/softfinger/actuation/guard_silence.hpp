#pragma once

#include "softfinger/actuation/process_state.hpp"

namespace softfinger {

/// The silence of a guard process, and whether it means that the guard hangs: told from one that a
/// busy machine gives no processor, or whose own clock was held, by what the system says of it.
class GuardSilence {
 public:
  /// One that is asleep, stopped or spins hangs after so long, s; one that waits for a device or
  /// for memory after kInDriver.
  static constexpr double kLongest = 0.09;
  static constexpr double kInDriver = 0.25;
  /// So often it is looked at, at different times, before that is believed.
  static constexpr int kLooksAsleep = 4;
  static constexpr int kLooksInDriver = 10;
  /// Of processor time without a sign of life, s.
  static constexpr double kSpinning = 0.07;

  /// What is seen of a silent guard from close by.
  struct Seen {
    double beat = 0.0;
    ProcessState state = ProcessState::kRunning;
  };
  /// One look at the guard: its last sign of life, how long ago that was (s), and the processor
  /// time it has used (s). Whether it hangs; `look` (a function that returns Seen) is asked where
  /// the silence goes on.
  template <typename Look>
  [[nodiscard]] bool tells_that_it_hangs(double beat, double silence, double processor_time,
                                         const Look& look) {
    if (!goes_on(beat, silence)) {
      begin(beat, processor_time);
      return false;
    }
    const Seen seen = look();
    if (seen.beat != beat) return false;  // that state was of a guard that had woken up
    return hangs(silence, seen.state, processor_time);
  }
  /// Whether the guard, whose last sign of life was `beat`, has been silent for a while, s, as it
  /// was at the look before; else a silence begins, with the processor time (s) used so far.
  [[nodiscard]] bool goes_on(double beat, double silence) const noexcept {
    return beat == beat_ && silence >= 0.5 * kLongest;
  }
  void begin(double beat, double processor_time) noexcept {
    *this = GuardSilence();
    beat_ = beat;
    processor_time_ = processor_time;
  }
  /// Of a silence that goes on: whether the guard hangs. `processor_time` counts where it runs.
  [[nodiscard]] bool hangs(double silence, ProcessState state, double processor_time) noexcept;

 private:
  double beat_ = 0.0;
  double processor_time_ = 0.0;
  int looks_asleep_ = 0;
  int looks_in_driver_ = 0;
};

}  // namespace softfinger
