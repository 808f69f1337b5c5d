#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "softfinger/actuation/command_delivery.hpp"
#include "softfinger/actuation/device_state.hpp"
#include "softfinger/actuation/stop_latch.hpp"
#include "softfinger/device/configuration.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

class Device;
class TravelCeiling;

struct ActuatorOptions {
  /// Port instead of the device file's transport.port: "emulator" or any tty. Empty: the file's.
  std::string port = {};
  /// Where the device was read from; messages name it and the line of the key.
  std::filesystem::path device_file = {};
  /// An absent port is no error; attempts to open it go on beside the run.
  bool wait_for_device = false;
  /// Nothing paces the run by the wall clock. The embedded emulator then advances with the times
  /// given to command(), without a thread, so that its servos repeat bit for bit. A real port is
  /// served in wall time all the same: it gets the newest command at the device's own rate, since
  /// motors know no other time.
  bool simulated_time = false;
  /// A program that calls serve_guarded_line(): it owns the port, in a process of its own, so that
  /// the device is retracted even where this process is killed. Needs device_file. Empty: a thread
  /// of this process owns the port.
  std::filesystem::path guard_program = {};
  /// No command advances the device further. Null: no limit of force.
  std::shared_ptr<const TravelCeiling> ceiling = nullptr;
};

/// What the loop wants of the device at one tick.
struct WantedMotion {
  Configuration configuration;  ///< q in the device's order; anything, NaN and infinity included
  bool tracked = true;          ///< false while the tracker has lost the finger
  bool touching = false;        ///< contact set not empty (only names the state)
  bool emergency = false;       ///< the device is stopped: retract at once, whatever is wanted
};

/// What is sent for it: within joint, rate, tilt and workspace limits whatever was wanted.
struct FormedCommand {
  static constexpr int kMaxServos = kMostServos;
  Configuration configuration;  ///< q nearest to the wanted one that may be sent now
  JointAngles joints;           ///< of that q; rad
  /// Up to where force limits let the device advance there; SI, infinite without a limit.
  double ceiling = std::numeric_limits<double>::infinity();
  bool force_limited = false;                      ///< what was wanted lies above that
  bool rate_limited = false;                       ///< its motors' rates keep it from there as yet
  std::array<std::int32_t, kMaxServos> targets{};  ///< steps of the wire, one per joint
  int servos = 0;  ///< how many of `targets` are used; 0 for a device without transport
  DeviceState state = DeviceState::kHoming;
};

/// Something worth one line to the user while a run goes on.
enum class ActuatorEvent : std::uint8_t {
  kPortAwaited,  ///< not to be opened at the start; only with wait_for_device
  kPortLost,
  kPortConnected,
  kLoopStalled,
  kStopped,         ///< by whom, see stop_latch()
  kReleased,        ///< follows again
  kReleaseRefused,  ///< why, see stop_latch()
  kGuardReplaced,   ///< the process that owned the port died or hung; another retracts the device
  kGuardLost,       ///< and none takes its place: nothing more is sent
  kUnwatched        ///< a real port is open for the first time: see MotorKind::left_alone
};

/// The way from a wanted configuration to the motors of one device: state machine, limits, servo
/// map, protocol, port or embedded emulator, watchdog.
///
/// Two guards of one kind stand in a row. The first bounds what the loop wants, on simulated time:
/// the same input gives the same FormedCommand in a live run, a headless run and a replay. The
/// second is the last function before the wire: in wall time, it starts from what was really sent
/// last, so a stall, a vanished port or a hung loop cannot make a jump. What it runs in, a thread
/// or a guard process, owns the port.
class Actuator {
 public:
  /// Opens the port (or the emulator). Throws InputError naming file, key and port when it cannot
  /// be opened, unless options.wait_for_device. Nothing is sent before the first command().
  Actuator(std::shared_ptr<const Device> device, const ActuatorOptions& options);
  /// As finish().
  ~Actuator();
  Actuator(const Actuator&) = delete;
  Actuator& operator=(const Actuator&) = delete;

  /// One device tick at run time `time` (s, increasing). Bounds `wanted` and hands it to the port.
  /// Never blocks, takes no lock, allocates nothing, throws nothing. The result stays valid until
  /// the next call. Ignored after finish().
  const FormedCommand& command(const WantedMotion& wanted, double time) noexcept;
  [[nodiscard]] const FormedCommand& last_command() const noexcept;

  /// Ends the run: commands lead to the device's retract configuration at each device tick and go
  /// on until 0.3 s after it is reached, then nothing more is sent. Blocks for that time in wall
  /// time; in simulated time with the emulator it takes none. A device that is disconnected is not
  /// waited for.
  void finish() noexcept;
  [[nodiscard]] bool finished() const noexcept;

  /// Stops the device: it retracts at once, whatever is commanded, and stays so until the stop of
  /// this number is released. With a line even where nothing is commanded any more; without one
  /// (simulated time, no transport) WantedMotion::emergency has to say it. Any thread; signal
  /// handlers too.
  StopLatch::Number stop(StopCause cause) noexcept;
  /// Asks to release the device from this stop; granted or refused by whoever leads the servos.
  /// False: it is not the newest stop, or was released. Any thread.
  bool ask_release(StopLatch::Number number, StopCause by = StopCause::kPerson) noexcept;
  /// What is known of stops: asked for, confirmed, refused releases. Any thread.
  [[nodiscard]] const StopLatch& stop_latch() const noexcept;

  /// State on the wire (disconnected while the port is gone, retracting while the loop stalls); of
  /// the last command with the emulator in simulated time. For display: not deterministic.
  [[nodiscard]] DeviceState state() const noexcept;
  /// The same of what has a line, from any thread; else empty.
  [[nodiscard]] std::optional<DeviceState> line_state() const noexcept;
  /// How long ago who leads the servos last showed life, s; NaN without a line. Any thread.
  [[nodiscard]] double line_silence() const noexcept;
  [[nodiscard]] bool connected() const noexcept;
  /// Waits in wall time until the port is open; for --wait-for-device.
  [[nodiscard]] bool wait_until_connected(std::chrono::milliseconds timeout) const;
  /// Commands that went out: one is the targets of all servos together.
  [[nodiscard]] std::uint64_t commands_sent() const noexcept;
  /// Where the servos are (rad, in the order of joints): the emulator's simulated servos, or what a
  /// Maestro that answers reports. Empty (false) where nothing is known. Call from the thread that
  /// calls command().
  bool read_servo_joints(JointAngles& joints) const noexcept;
  /// How long the newest command that went out took from here, each told once; empty also in
  /// simulated time. Call from the thread that calls command().
  std::optional<CommandDelivery> take_delivery() noexcept;
  /// "emulator" or the tty's name.
  [[nodiscard]] const std::string& port() const noexcept;

  /// The next event not yet taken, if any; any one thread. Each loss of the port is told once.
  std::optional<ActuatorEvent> take_event() noexcept;
  /// One line for people about an event, with the port's name.
  [[nodiscard]] std::string message(ActuatorEvent event) const;
  /// One line with the port and the reason where it has never been open yet.
  [[nodiscard]] std::optional<std::string> never_opened() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softfinger
