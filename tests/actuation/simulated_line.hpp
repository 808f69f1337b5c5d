#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/actuation/line_channel.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/wire/line_clock.hpp"

namespace softfinger {

/// The far end of a line under test: an emulated board, and what it was told.
struct Board {
  std::unique_ptr<BusEmulator> bus;
  std::function<void()> reset;                      ///< cuts its power for a moment
  std::function<std::uint64_t()> commands;          ///< taken so far
  std::function<std::int32_t(std::size_t)> target;  ///< of a servo, steps of the wire; 0: none
};
/// A board of the device's transport whose servos stand at q.
Board board_at(const Device& device, const Configuration& q);

/// One servo line, from the wanted q of a loop over a pseudo-terminal to an emulated board, in
/// simulated time: nothing happens while the line runs, and time goes on where the line sleeps, by
/// as much as it sleeps. Bytes arrive at once. What happens does not depend on how busy the machine
/// is, and repeats.
class SimulatedLine final : public LineClock {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Sent {
    double time = 0.0;   ///< s
    JointAngles joints;  ///< of the board's targets; rad
  };

  explicit SimulatedLine(std::shared_ptr<const Device> device);
  ~SimulatedLine() override;

  /// What the loop wants at a time (s), asked at each device tick; none: it says nothing.
  std::function<std::optional<Configuration>(double)> wanted;
  bool touching = false;  ///< what the loop says of it
  /// What a defect of the loop does to a command between the two; empty: nothing.
  std::function<void(LineChannel::Wanted&)> spoil;
  std::function<void(LineChannel::Sent&)> spoil_sent;
  /// The process that wants something, which ends when this is closed; -1: it goes on.
  int loop = -1;
  /// What becomes of bytes on their way; empty: nothing.
  std::function<void(Bytes&)> to_board;
  std::function<void(Bytes&)> from_board;

  /// Something to happen at a time, s.
  void at(double time, std::function<void()> event);
  /// The port is there from now on, with this board behind it (which outlives the run).
  void plug_in(Board& board);
  /// The port is gone for whoever has it open.
  void unplug();
  /// Opens the port and serves the line until `until` (s), then retracts and ends as a run does.
  void run(double until);

  [[nodiscard]] double time() const;  ///< s since the start
  /// Every change of the board's targets, in the order of time.
  [[nodiscard]] const std::vector<Sent>& sent() const { return sent_; }
  /// Where the board's servos stand; rad.
  [[nodiscard]] JointAngles standing() const;
  [[nodiscard]] const LineChannel& channel() const { return channel_; }
  /// Another line had the channel before, and sent this last.
  void was_sent_before(const Configuration& q);
  /// As LineEnd has them.
  StopLatch::Number stop(StopCause cause = StopCause::kPerson);
  void ask_release(StopLatch::Number number);
  /// What the servos reported last, where they did.
  [[nodiscard]] std::optional<JointAngles> reported();
  /// What the line says it sent last, for whoever takes its place.
  [[nodiscard]] LineChannel::Sent said_to_be_sent();
  /// How long the last command took that was told of, where one was.
  [[nodiscard]] std::optional<CommandDelivery> delivered();
  [[nodiscard]] double period() const;  ///< of device ticks, s

  [[nodiscard]] TimePoint now() noexcept override { return now_; }
  void sleep_until(TimePoint due) noexcept override;
  bool wait(std::span<pollfd> events, TimePoint due) noexcept override;

 private:
  void advance(TimePoint due);
  void settle();
  Bytes take_written();
  void deliver(const Bytes& bytes);
  void note_targets();
  void loop_tick();
  void wake();

  std::shared_ptr<const Device> device_;
  LineChannel channel_;
  TimePoint now_{std::chrono::hours(1)};
  TimePoint start_ = now_;
  std::multimap<TimePoint, std::function<void()>> events_;
  long ticks_ = 0;
  std::uint64_t submitted_ = 0;
  int wake_ = -1;
  std::string name_;  ///< of the port, as stable as those of USB adapters
  int near_ = -1;     ///< the board's end
  int far_ = -1;      ///< the line's end, held open
  Board* board_ = nullptr;
  std::uint64_t commands_ = 0;
  std::vector<Sent> sent_;
};

}  // namespace softfinger
