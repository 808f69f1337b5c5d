#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/contact/contact_sums.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// How a Rendering is built from a scene file.
struct RenderingOptions {
  std::string finger;            ///< name of a finger in the scene; empty: the first
  std::filesystem::path device;  ///< device file instead of the scene's; empty: the scene's
  /// Send the commands to the port named by the device file, at the device's own rate, with its
  /// watchdog: when calls stop coming, the device retracts. Else commands are only formed. Refused
  /// where there is no device, or its file names no port.
  bool open_device = false;
  /// softfinger-guard, which then owns the port, in a process of its own: whatever becomes of this
  /// one, the device is retracted. Empty: the one beside this program, or where softfinger was
  /// installed; where there is none, opening a device is refused.
  std::filesystem::path guard_program;
  /// A thread of this process owns the port instead. It outlives a program that hangs, not one that
  /// is killed or crashes.
  bool without_guard_process = false;
  /// Person file: sizes of the fingers, instead of the finger files'; see also registration().
  std::filesystem::path person;
  /// Poses are smoothed by the one-euro filter of `softfinger run --filter`.
  bool filter = false;
  /// Poses are carried on by this much at the velocity they have, as by `--predict-ms`: s, 0 to
  /// 0.05.
  std::optional<double> predict;
  /// Records to this file, which must not exist yet; `softfinger replay`, `export` and `report`
  /// read it. With an open device rows are left out rather than waited for.
  std::filesystem::path recording;
  bool record_state = false;  ///< nodes and samples of every step as well
};

/// What the device of the finger is told. Empty vectors where the scene names no device.
struct RenderingCommand {
  std::int64_t tick = -1;         ///< counts the device ticks, from 0; -1 before the first
  double time = 0.0;              ///< s, of that tick
  Eigen::VectorXd configuration;  ///< q in the device's order; rad and m
  Eigen::VectorXd joints;         ///< joints of q; rad, or m for linear ones
  /// One a servo, as its bus has it: a pulse width in s, or a position in ticks, or a share.
  Eigen::VectorXd set_points;
  Eigen::VectorXd pulse_widths;  ///< the same numbers under their older name
  double deviation = 0.0;        ///< E of the match, m^2; 0 when nothing is touched
  std::string_view state;        ///< homing, ready, rendering, holding, retracting, ...
  bool stopped = false;          ///< see Rendering::stop()
  /// The stop is a fact: who leads the servos has led them away since.
  bool stop_confirmed = false;
  std::uint32_t stops = 0;  ///< how often the device was stopped so far, by whomever
};

/// The finger as simulated, with the sums of its contact: contact_area, normal_force, centroid_F,
/// and so on. F is the simulated distal phalanx, W the world.
struct RenderingSnapshot : ContactSums {
  double time = 0.0;                        ///< s, end of the last step
  Pose X_WFt;                               ///< tracked
  Pose X_WF;                                ///< simulated; stays behind the tracked pose in contact
  std::vector<Vector3> sample_positions_F;  ///< m, deformed skin
  std::vector<double> sample_pressures;     ///< Pa
  std::vector<bool> in_contact;             ///< whether skin around each sample touches
  std::vector<Pose> X_WO;                   ///< where each object is
};

/// The whole chain for those who bring their own program and tracker: a soft finger explores the
/// scene's objects, a device answers.
///
///     softfinger::Rendering rendering("scenes/sphere.toml");
///     while (tracking) {
///       const auto& command = rendering.step(tracked_pose(), seconds_since_start());
///       ...
///     }
///
/// Time advances in steps of the scene's simulation rate. The same calls give the same bits. One
/// thread at a time.
class Rendering {
 public:
  /// Reads the scene and the finger and device files it names; trackers and waypoints in it are
  /// ignored. Throws InputError (a std::runtime_error) with file, line and key.
  explicit Rendering(const std::filesystem::path& scene, const RenderingOptions& options = {});
  ~Rendering();
  Rendering(Rendering&&) noexcept;
  Rendering& operator=(Rendering&&) noexcept;

  /// Simulates up to `time` (s, on any clock; the first call says where it begins and places the
  /// finger) and returns the newest command. X_WFt: tracked distal phalanx Ft in W, m; between
  /// calls it moves straight. Time that does not advance by a step gives the last command; a gap of
  /// more than a second is skipped, not simulated. A pose with numbers that are not finite is lost
  /// tracking: the device holds, after 200 ms it retracts. Throws nothing and, after the first
  /// call that simulates, allocates nothing.
  const RenderingCommand& step(const Pose& X_WFt, double time);
  /// Tracking is lost; else as step().
  const RenderingCommand& lost(double time);

  /// Stops the device: it retracts at once, whatever is wanted, also while nobody calls step(), and
  /// stays so until it is released. Any thread; signal handlers too.
  void stop() noexcept;
  /// Asks to release it from the stops that the last call of step() told of. A stop since then
  /// stays. Granted once the device is retracted and nothing is wrong: RenderingCommand::stopped
  /// says so. False: nothing is stopped, or it was stopped again.
  bool release() noexcept;

  /// The next line that a person should read of the device, each told once: what its file asks them
  /// to know, that its port is gone or back, that it was stopped and by whom. Allocates.
  [[nodiscard]] std::optional<std::string> take_message();

  /// The finger after the last step.
  [[nodiscard]] RenderingSnapshot snapshot() const;
  /// The same into one that is kept: from the second time on nothing is allocated.
  void snapshot(RenderingSnapshot& snapshot) const;

  [[nodiscard]] double simulation_rate() const;  ///< Hz
  [[nodiscard]] double device_rate() const;      ///< Hz; 0 without a device
  [[nodiscard]] int joint_count() const;         ///< 0 without a device
  /// Names of the components of q with the unit people read: pitch_deg, ...
  [[nodiscard]] std::vector<std::string> configuration_names() const;
  /// Corners of the skin's triangles, counter-clockwise from outside, as indices into
  /// RenderingSnapshot::sample_positions_F.
  [[nodiscard]] const std::vector<std::array<int, 3>>& skin_triangles() const;
  /// Names of the objects, in the order of RenderingSnapshot::X_WO; empty where one has none.
  [[nodiscard]] std::vector<std::string> object_names() const;
  /// X_BodyFt of the person file for this finger: of a tracked body step() wants X_WBody X_BodyFt.
  /// Empty where the file says none.
  [[nodiscard]] std::optional<Pose> registration() const;

  /// Writes what is left of the recording and closes it; steps after that are not recorded. Throws
  /// OperationError (a std::runtime_error) where something could not be written. The destructor
  /// does the same without a word.
  void close_recording();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
