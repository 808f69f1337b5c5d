#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "softfinger/actuation/guard_setup.hpp"
#include "softfinger/actuation/line_end.hpp"

namespace softfinger {

/// A servo line served by a process of its own, which owns the port: what happens to this process,
/// kill -9 included, the device is retracted. The two share a LineChannel; a socket between them
/// tells each that the other is gone.
class GuardProcess final : public LineEnd {
 public:
  /// `program`: one that calls serve_guarded_line(), i.e. softfinger-guard. Throws OperationError
  /// where the system has no memory to share.
  GuardProcess(std::filesystem::path program, const Configuration& home, GuardSetup setup);
  /// As finish().
  ~GuardProcess() override;

  /// Throws OperationError where the program does not start.
  [[nodiscard]] std::string start(bool wait_for_device) override;
  void finish() noexcept override;
  [[nodiscard]] bool is_served() noexcept override;
  /// Its number; negative: none runs.
  [[nodiscard]] int process() const { return process_; }

 private:
  void spawn();
  [[nodiscard]] std::string tell_and_ask();

  std::filesystem::path program_;
  GuardSetup setup_;
  int memory_ = -1;
  int socket_ = -1;
  int process_ = -1;  ///< -1: none
};

/// What the guard program does, all of it: reads the setup from its parent, serves the line until
/// told to end or until the parent is gone, then retracts the device, and returns the program's
/// exit status.
int serve_guarded_line();

}  // namespace softfinger
