#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "softfinger/actuation/command_delivery.hpp"
#include "softfinger/actuation/device_state.hpp"
#include "softfinger/actuation/stop_latch.hpp"
#include "softfinger/device/configuration.hpp"
#include "softfinger/motors/servo_faults.hpp"
#include "softfinger/motors/transport_settings.hpp"
#include "softfinger/threads/mailbox.hpp"

namespace softfinger {

/// What passes between a loop and the line that serves its device's port: newest values only, and
/// wait-free both ways. Loop and line may live in two processes that share these bytes, so nothing
/// in here points anywhere.
struct LineChannel {
  struct Wanted {
    Configuration q;
    DeviceState state = DeviceState::kHoming;  ///< of the loop that wants it
    double formed = 0.0;                       ///< s, monotonic clock
    std::uint64_t number = 0;                  ///< each is larger than the one before it
    std::uint64_t seal = 0;                    ///< of all that, see is_whole()

    [[nodiscard]] std::uint64_t seal_of_this() const noexcept;
    /// Whether it is what was published: either process may have a defect that writes anywhere.
    [[nodiscard]] bool is_whole() const noexcept { return seal == seal_of_this(); }
  };
  /// What was sent to the servos last.
  struct Sent {
    Configuration q;
    std::uint64_t seal = 0;

    [[nodiscard]] std::uint64_t seal_of_this() const noexcept;
    [[nodiscard]] bool is_whole() const noexcept { return seal == seal_of_this(); }
  };
  /// Where the servos said they are.
  struct Report {
    JointAngles joints;
    bool known = false;
  };

  explicit LineChannel(const Configuration& home)
      : wanted(Wanted{.q = home}), report(Report{home, false}), sent(Sent{.q = home}) {}

  Mailbox<Wanted> wanted;             ///< from the loop
  Mailbox<Report> report;             ///< from the line
  Mailbox<Sent> sent;                 ///< from the line, to the line that takes its place
  Mailbox<CommandDelivery> delivery;  ///< from the line, of each wanted q that was sent
  std::atomic<bool> ending{false};    ///< the loop wants the line to retract the device and to end

  StopLatch stop;  ///< the line obeys it, whatever the loop wants
  /// Counted up by who wants to know whether a stop would be heard; the line answers with the same.
  std::atomic<std::uint32_t> question{0}, answer{0};

  // What the line says of itself.
  /// When it last showed life, s on the monotonic clock; 0: not yet.
  std::atomic<double> beat{0.0};
  /// How long ago that was, s.
  [[nodiscard]] double silence(double now) const noexcept {
    return now - beat.load(std::memory_order_acquire);
  }
  std::atomic<ServoFaults> faults{};
  /// Servos that answer and do not follow, bits as in ServoFaults.
  std::atomic<std::uint32_t> astray{0};
  /// Of each servo, bits of ServoComplaint.
  std::array<std::atomic<std::uint8_t>, kMostServos> complaints{};
  std::atomic<bool> connected{false};
  std::atomic<DeviceState> state{DeviceState::kDisconnected};
  std::atomic<std::uint64_t> commands_sent{0};
  std::atomic<std::uint64_t> commands_refused{0};  ///< not whole, or older than one before
  std::atomic<std::uint32_t> times_lost{0};
  std::atomic<std::uint32_t> times_connected{0};  ///< after the first time
  std::atomic<std::uint32_t> times_stalled{0};
};

static_assert(std::atomic<bool>::is_always_lock_free &&
              std::atomic<DeviceState>::is_always_lock_free &&
              std::atomic<std::uint64_t>::is_always_lock_free &&
              std::atomic<double>::is_always_lock_free &&
              std::atomic<ServoFaults>::is_always_lock_free);

}  // namespace softfinger
