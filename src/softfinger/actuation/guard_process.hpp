#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>

#include "softfinger/actuation/guard_setup.hpp"
#include "softfinger/actuation/guard_silence.hpp"
#include "softfinger/actuation/line_end.hpp"

namespace softfinger {

/// A servo line served by a process of its own, which owns the port: what happens to this process,
/// kill -9 included, the device is retracted. The two share a LineChannel; a socket between them
/// tells each that the other is gone.
///
/// The guard is watched in turn: one that dies, is stopped, or hangs is ended, and another takes
/// its place. That one begins stopped (StopCause::kGuard): it retracts the device from where the
/// first one sent it, and nothing starts again before somebody releases it.
class GuardProcess final : public LineEnd {
 public:
  /// So many guards in a row that end within kShortLife (s) are not replaced any more.
  static constexpr int kMostReplacements = 3;
  static constexpr double kShortLife = 10.0;

  /// `program`: one that calls serve_guarded_line(), i.e. softfinger-guard. Throws OperationError
  /// where the system has no memory to share.
  GuardProcess(std::filesystem::path program, const Configuration& home, GuardSetup setup);
  /// As finish().
  ~GuardProcess() override;

  /// Throws OperationError where the program does not start.
  [[nodiscard]] std::string start(bool wait_for_device) override;
  void finish() noexcept override;
  [[nodiscard]] bool is_served() noexcept override { return process_ >= 0; }
  [[nodiscard]] std::uint32_t replacements() const noexcept override { return replacements_; }
  /// Its number; negative: none runs.
  [[nodiscard]] int process() const { return process_; }

 private:
  void spawn();
  [[nodiscard]] std::string tell_and_ask();
  void watch() noexcept;
  [[nodiscard]] bool has_ended() noexcept;
  [[nodiscard]] bool hangs() noexcept;
  [[nodiscard]] bool replace() noexcept;
  void await_death() noexcept;
  void close_socket() noexcept;

  std::filesystem::path program_;
  GuardSetup setup_;
  int memory_ = -1;
  int socket_ = -1;
  std::atomic<int> process_{-1};  ///< -1: none
  std::atomic<std::uint32_t> replacements_{0};
  std::chrono::steady_clock::time_point began_;  ///< the one that runs
  int short_lives_ = 0;                          ///< of the last ones, in a row
  GuardSilence silence_;
  std::thread watch_;
};

/// What the guard program does, all of it: reads the setup from its parent, serves the line until
/// told to end or until the parent is gone, then retracts the device, and returns the program's
/// exit status.
int serve_guarded_line();

}  // namespace softfinger
