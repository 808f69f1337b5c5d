#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/contact/contact_sums.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// How a Rendering is built from a scene file.
struct RenderingOptions {
  std::string finger;  ///< name of a finger in the scene; empty: the first
  /// All fingers of the scene instead, in its order: they touch the same objects, which they can
  /// hold between them.
  bool all_fingers = false;
  /// Device file instead of the scene's; empty: the scene's. NAME=FILE for one of several fingers.
  std::filesystem::path device;
  /// Threads that step several fingers side by side, with the same bits on any number of them.
  int threads = 1;
  /// Send the commands to the port named by the device file (of all fingers, each its own), at the
  /// device's own rate, with its watchdog: when calls stop coming, the device retracts. Else
  /// commands are only formed. Refused where there is no device, or its file names no port.
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

/// An object as it is and moves after the last step.
struct RenderingObject {
  Pose X_WO;
  bool moves = false;                  ///< by the forces on it, as a whole or in part
  Vector3 velocity = Vector3::Zero();  ///< of its centre of mass, W, m/s; zero unless it moves
  Vector3 angular_velocity = Vector3::Zero();  ///< W, rad/s
  /// Of a slider (m) or hinge (rad); NaN: it has neither.
  double joint = std::numeric_limits<double>::quiet_NaN();
};

/// Something that happened to an object that moves by forces (docs/files.md, events.csv).
struct RenderingEvent {
  double time = 0.0;       ///< s, on the caller's clock
  std::string_view kind;   ///< impact, release, click, detent, limit
  std::size_t object = 0;  ///< its place among the objects
  std::optional<std::size_t> other_object = {};
  std::optional<std::size_t> other_finger = {};
  double impulse = std::numeric_limits<double>::quiet_NaN();  ///< N s; NaN: none
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
  std::vector<RenderingObject> objects;     ///< and how it moves
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
///
/// With several fingers (RenderingOptions::all_fingers) step() takes a pose for each, and what is
/// asked of one has its number, from 0 in the order of the scene; it must be less than
/// finger_count().
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
  /// The same for all fingers; of one whose tracking is lost there is no pose. Throws InputError
  /// where there is not one for each finger.
  void step(std::span<const std::optional<Pose>> X_WFt, double time);
  /// The newest.
  [[nodiscard]] const RenderingCommand& command(std::size_t finger = 0) const;

  /// The caller has an object where it is now: X_WO at the time of the next call that simulates,
  /// until when it moves straight. From then on it stays where it was put last, whatever its file
  /// says; before the first call it is there from the start. Throws InputError where there is no
  /// such object, it moves by forces, something hangs on it by a joint, the pose is not finite, or
  /// a recording is made, which could not be replayed. Allocates nothing.
  void move_object(std::size_t object, const Pose& X_WO);

  /// Stops the device, or all of them: it retracts at once, whatever is wanted, also while nobody
  /// calls step(), and stays so until it is released. Any thread; signal handlers too.
  void stop() noexcept;
  /// Asks to release it from the stops that the last call of step() told of. A stop since then
  /// stays. Granted once the device is retracted and nothing is wrong: RenderingCommand::stopped
  /// says so. False: nothing is stopped, or it was stopped again.
  bool release() noexcept;

  /// The next line that a person should read of the device, each told once: what its file asks them
  /// to know, that its port is gone or back, that it was stopped and by whom; of several fingers
  /// with the name of its own before it. Allocates.
  [[nodiscard]] std::optional<std::string> take_message();
  /// The next event of the objects, in the order in which they were found, each told once. Of more
  /// than 256 that wait the oldest are forgotten.
  [[nodiscard]] std::optional<RenderingEvent> take_event();

  /// The finger, or the first one, after the last step.
  [[nodiscard]] RenderingSnapshot snapshot() const;
  /// The same into one that is kept: from the second time on nothing is allocated.
  void snapshot(RenderingSnapshot& snapshot, std::size_t finger = 0) const;

  [[nodiscard]] double simulation_rate() const;  ///< Hz
  [[nodiscard]] std::size_t finger_count() const;
  [[nodiscard]] std::vector<std::string> finger_names() const;
  [[nodiscard]] double device_rate(std::size_t finger = 0) const;  ///< Hz; 0 without a device
  [[nodiscard]] int joint_count(std::size_t finger = 0) const;     ///< 0 without a device
  /// Names of the components of q with the unit people read: pitch_deg, ...
  [[nodiscard]] std::vector<std::string> configuration_names(std::size_t finger = 0) const;
  /// Corners of the skin's triangles, counter-clockwise from outside, as indices into
  /// RenderingSnapshot::sample_positions_F.
  [[nodiscard]] const std::vector<std::array<int, 3>>& skin_triangles(std::size_t finger = 0) const;
  /// Names of the objects, in the order of RenderingSnapshot::X_WO; empty where one has none.
  [[nodiscard]] std::vector<std::string> object_names() const;
  /// The surface of a soft object, counter-clockwise from outside, as indices into its
  /// object_positions(); of one that keeps its shape none.
  [[nodiscard]] const std::vector<std::array<int, 3>>& object_triangles(std::size_t object) const;
  /// As it is deformed after the last step, W, m. The second time nothing is allocated.
  void object_positions(std::size_t object, std::vector<Vector3>& positions_W) const;
  /// X_BodyFt of the person file for this finger: of a tracked body step() wants X_WBody X_BodyFt.
  /// Empty where the file says none.
  [[nodiscard]] std::optional<Pose> registration(std::size_t finger = 0) const;

  /// Writes what is left of the recording and closes it; steps after that are not recorded. Throws
  /// OperationError (a std::runtime_error) where something could not be written. The destructor
  /// does the same without a word.
  void close_recording();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
