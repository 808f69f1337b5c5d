#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

#include "softfinger/base/name_table.hpp"

namespace softfinger {

/// Who or what stopped a device.
enum class StopCause : std::uint8_t {
  kNone,
  kPerson,   ///< on the page
  kSignal,   ///< SIGUSR1: a pedal, a script
  kProgram,  ///< that uses the library
  kRun,      ///< what must not move: a registration
  kEarlier,  ///< the run before this one was stopped, and is still
  kServo,    ///< a servo that does not answer or follow, has lost its torque or protects itself
  kPressed,  ///< the finger was pressed for too long without a pause
  kGuard,    ///< the process that guards the port died or hung
};
inline constexpr std::array<NameRow<StopCause>, 9> kStopCauses{{
    {StopCause::kNone, "none", "nothing"},
    {StopCause::kPerson, "person", "somebody at the page"},
    {StopCause::kSignal, "signal", "a signal"},
    {StopCause::kProgram, "program", "the program"},
    {StopCause::kRun, "run", "the run itself"},
    {StopCause::kEarlier, "earlier", "a stop of the run before"},
    {StopCause::kServo, "servo", "a servo's fault"},
    {StopCause::kPressed, "pressed", "pressing for too long without a pause"},
    {StopCause::kGuard, "guard", "a fault of the port's guard"},
}};

/// Why a release was not granted.
enum class ReleaseRefusal : std::uint8_t {
  kNone,
  kPortClosed,  ///< nobody knows where the servos are
  kServoFault,  ///< still there
  kNoCommands,  ///< the loop says nothing fresh
  kRetracting,  ///< not retracted yet
};
inline constexpr std::array<NameRow<ReleaseRefusal>, 5> kReleaseRefusals{{
    {ReleaseRefusal::kNone, "none", "nothing is wrong"},
    {ReleaseRefusal::kPortClosed, "port_closed", "its port is not open"},
    {ReleaseRefusal::kServoFault, "servo_fault",
     "a servo does not answer or follow, or has no torque"},
    {ReleaseRefusal::kNoCommands, "no_commands", "no fresh command comes from the run"},
    {ReleaseRefusal::kRetracting, "retracting", "it is not retracted yet"},
}};

/// Stop and release of one device. Stops are numbered, and latched: a release names the stop that
/// it ends and is nothing against a later one, so that a press that is repeated or comes late
/// releases nothing (ISO 13850: a reset is an act of its own and starts nothing by itself).
///
/// A release is only asked for here; whoever leads the device grants or refuses it. Lock-free, any
/// thread, and no pointers: processes may share it. What only the leader calls says so.
class StopLatch {
 public:
  using Number = std::uint32_t;  ///< 0: there was no stop

  /// Signal handlers too. Returns the stop's number.
  Number stop(StopCause cause) noexcept {
    cause_.store(cause, std::memory_order_relaxed);
    return newest_.fetch_add(1, std::memory_order_acq_rel) + 1;
  }
  /// Asks to end the stop of this number; false: it is not the newest, or has ended.
  bool ask_release(Number number, StopCause by = StopCause::kPerson) noexcept {
    if (number != newest() || !is_stopped()) return false;
    asked_by_.store(by, std::memory_order_relaxed);
    asked_.store(number, std::memory_order_release);
    return true;
  }

  /// Who asked for the newest release.
  [[nodiscard]] StopCause asked_by() const noexcept {
    return asked_by_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_stopped() const noexcept { return newest() != released(); }
  [[nodiscard]] Number newest() const noexcept { return newest_.load(std::memory_order_acquire); }
  [[nodiscard]] Number released() const noexcept {
    return released_.load(std::memory_order_acquire);
  }
  /// Of the newest stop.
  [[nodiscard]] StopCause cause() const noexcept { return cause_.load(std::memory_order_relaxed); }
  /// The newest stop that is a fact: since then the leader has led the device away.
  [[nodiscard]] Number confirmed() const noexcept {
    return confirmed_.load(std::memory_order_acquire);
  }
  /// Releases that were refused so far, and why the last one was.
  [[nodiscard]] std::uint32_t refusals() const noexcept {
    return refusals_.load(std::memory_order_acquire);
  }
  [[nodiscard]] ReleaseRefusal refusal() const noexcept {
    return refusal_.load(std::memory_order_relaxed);
  }

  /// The leader: a first command away from the finger has gone out since stop `number`.
  void confirm(Number number) noexcept { confirmed_.store(number, std::memory_order_release); }
  /// The leader: whether somebody asks to release the newest stop.
  [[nodiscard]] bool release_is_asked() const noexcept {
    return is_stopped() && asked_.load(std::memory_order_acquire) == newest();
  }
  /// The leader: answers that. A stop that came meanwhile stays.
  void answer_release(ReleaseRefusal reason) noexcept {
    const Number asked = asked_.exchange(0, std::memory_order_acq_rel);
    if (asked == 0) return;
    if (reason == ReleaseRefusal::kNone) {
      released_.store(asked, std::memory_order_release);
    } else {
      refusal_.store(reason, std::memory_order_relaxed);
      refusals_.fetch_add(1, std::memory_order_acq_rel);
    }
  }

 private:
  std::atomic<Number> newest_{0};
  std::atomic<Number> released_{0};
  std::atomic<Number> asked_{0};  ///< 0: nobody asks
  std::atomic<Number> confirmed_{0};
  std::atomic<std::uint32_t> refusals_{0};
  std::atomic<StopCause> cause_{StopCause::kNone};
  std::atomic<StopCause> asked_by_{StopCause::kNone};
  std::atomic<ReleaseRefusal> refusal_{ReleaseRefusal::kNone};
};

static_assert(std::atomic<StopLatch::Number>::is_always_lock_free &&
              std::atomic<StopCause>::is_always_lock_free &&
              std::atomic<ReleaseRefusal>::is_always_lock_free);

}  // namespace softfinger
