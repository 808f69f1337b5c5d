#pragma once

#include <memory>
#include <thread>

#include "softfinger/actuation/line_end.hpp"
#include "softfinger/actuation/servo_line.hpp"

namespace softfinger {

/// A servo line served by a thread of this process. It outlives a loop that hangs, not a process
/// that is killed; GuardProcess outlives both.
class LineThread final : public LineEnd {
 public:
  LineThread(std::shared_ptr<const Device> device, const ServoLine::Options& options);
  /// As finish().
  ~LineThread() override;

  [[nodiscard]] std::string start(bool wait_for_device) override;
  void finish() noexcept override;
  [[nodiscard]] bool is_served() noexcept override { return thread_.joinable(); }

 private:
  LineChannel bytes_;
  ServoLine line_;
  std::thread thread_;
};

}  // namespace softfinger
