#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "softfinger/actuation/line_channel.hpp"

namespace softfinger {

/// The loop's end of a servo line, wherever the line itself is served.
class LineEnd {
 public:
  /// Throws OperationError where the system has no more event descriptors.
  LineEnd();
  virtual ~LineEnd();
  LineEnd(const LineEnd&) = delete;
  LineEnd& operator=(const LineEnd&) = delete;

  /// Has the port opened and the line served. Returns an empty text or, in few words, why the port
  /// cannot be opened; the line is then served only if `wait_for_device`.
  [[nodiscard]] virtual std::string start(bool wait_for_device) = 0;
  /// Retracts the device, repeats the command, ends the line. Nothing is sent if nothing was ever
  /// submitted. Blocks as long.
  virtual void finish() noexcept = 0;
  /// Whether somebody still serves the line.
  [[nodiscard]] virtual bool is_served() noexcept = 0;
  /// How often who served it had to be replaced.
  [[nodiscard]] virtual std::uint32_t replacements() const noexcept { return 0; }

  /// Asks, on the way of a stop and before anything is commanded, whether one would be heard;
  /// false: nobody has answered for `patience`. After start(). Blocks as long.
  [[nodiscard]] bool would_hear_a_stop(std::chrono::milliseconds patience) noexcept;
  /// Newest wanted q and the state of the loop that wants it. From one thread; wait-free.
  void submit(const Configuration& q, DeviceState state) noexcept;
  /// Stops the device at once, see StopLatch. Any thread; signal handlers too.
  StopLatch::Number stop(StopCause cause) noexcept;
  /// Asks to release it. Any thread.
  bool ask_release(StopLatch::Number number, StopCause by) noexcept;
  /// Joint angles by the positions the servos report; false where they never answered. From the
  /// thread that submits.
  bool read_joints(JointAngles& joints) noexcept;
  /// How long the newest wanted q took that was sent, each told once. From the thread that submits.
  std::optional<CommandDelivery> take_delivery() noexcept;
  /// What the line says of itself.
  [[nodiscard]] const LineChannel& channel() const { return *channel_; }

 protected:
  void wake() noexcept;
  [[nodiscard]] int wake_descriptor() const { return wake_; }

  LineChannel* channel_ = nullptr;  ///< set by the constructor of whoever has the bytes

 private:
  std::uint64_t submitted_ = 0;
  int wake_ = -1;  ///< event descriptor: counting up never blocks and needs no lock
};

}  // namespace softfinger
