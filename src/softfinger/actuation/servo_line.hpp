#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "softfinger/actuation/device_state.hpp"
#include "softfinger/actuation/motion_guard.hpp"
#include "softfinger/actuation/servo_bus.hpp"
#include "softfinger/base/mailbox.hpp"
#include "softfinger/device/device.hpp"

namespace softfinger {

/// The servos of one device on their bus, served by a thread of its own in wall time. The thread
/// owns the port and is the watchdog: when no fresh command comes it repeats the last one, after
/// kStallTime it retracts the device, and it opens a port that went away again. Its own MotionGuard
/// starts from what was really sent last (or from where the servos say they are), so nothing
/// upstream can cause a jump.
class ServoLine {
 public:
  struct Options {
    std::string port;
    double rate = 30.0;  ///< device ticks per s
    /// Commands may come faster than `rate`; only the newest at each tick is sent.
    bool unpaced = false;
    std::shared_ptr<const TravelCeiling> ceiling = nullptr;  ///< null: none
  };

  /// `bus` has the servos of the device's `[transport]`.
  ServoLine(std::shared_ptr<const Device> device, std::unique_ptr<ServoBus> bus, Options options);
  /// As finish().
  ~ServoLine();
  ServoLine(const ServoLine&) = delete;
  ServoLine& operator=(const ServoLine&) = delete;

  /// Before start(): opens the port. Returns an empty text or why it cannot be opened.
  [[nodiscard]] std::string open();
  /// Starts the thread, with the port open or not.
  void start();

  /// Newest wanted q and the state of the loop that wants it. From one thread; wait-free.
  void submit(const Configuration& q, DeviceState state) noexcept;
  /// Retracts, repeats, stops the thread. Nothing is sent if nothing was ever submitted.
  void finish() noexcept;

  [[nodiscard]] DeviceState state() const { return state_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool connected() const { return connected_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t commands_sent() const {
    return sent_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint32_t times_lost() const { return lost_.load(std::memory_order_acquire); }
  /// Connections made by the thread, the one of open() not counted.
  [[nodiscard]] std::uint32_t times_connected() const {
    return connections_.load(std::memory_order_acquire);
  }
  [[nodiscard]] std::uint32_t times_stalled() const {
    return stalls_.load(std::memory_order_acquire);
  }
  /// Joint angles by the positions the servos report; false where it never answered. From the
  /// thread that submits.
  bool read_joints(JointAngles& joints) noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  struct Wanted {
    Configuration q;
    DeviceState state = DeviceState::kHoming;
  };
  /// What the servos reported.
  struct Report {
    JointAngles joints;
    bool known = false;
  };

  void serve();
  void try_to_connect(Clock::time_point now);
  void note_loss();
  void wait_until(Clock::time_point due);  ///< or until something was submitted
  /// Asks for the positions and waits a little; true when they place the device in its workspace.
  bool learn_positions();
  /// Takes an answer that has arrived complete; false if there is none.
  bool take_positions(JointAngles& joints);
  bool tick(Clock::time_point now);  ///< false: stopped
  void wake() noexcept;

  std::shared_ptr<const Device> device_;
  Options options_;
  Clock::duration period_;
  std::unique_ptr<ServoBus> bus_;
  MotionGuard guard_;
  DeviceStateMachine machine_;

  // The thread's own.
  Clock::time_point start_;
  Clock::time_point last_sent_;
  Clock::time_point last_fresh_;
  Clock::time_point next_attempt_;
  bool positions_unknown_ = true;   ///< since the port was opened
  Clock::time_point homing_until_;  ///< positions unknown: stay at the first pose until then
  bool fresh_ever_ = false;
  bool stalled_ = false;
  bool answers_ = false;  ///< the servos answered when the port was opened

  Mailbox<Wanted> wanted_;
  Mailbox<Report> report_;
  int wake_ = -1;  ///< event descriptor: counting up never blocks and needs no lock
  std::atomic<bool> ending_{false};
  std::atomic<bool> connected_{false};
  std::atomic<DeviceState> state_{DeviceState::kDisconnected};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint32_t> lost_{0};
  std::atomic<std::uint32_t> connections_{0};
  std::atomic<std::uint32_t> stalls_{0};
  std::thread thread_;
};

}  // namespace softfinger
