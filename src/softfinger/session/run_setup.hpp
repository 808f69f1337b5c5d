#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/recording/recording_info.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/session/stop_signals.hpp"
#include "softfinger/session/worn_device.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

namespace softfinger {

/// Which scene, with what instead of what its file names. Scene, devices and wearer are files or
/// names of shipped ones.
struct SetupOptions {
  std::filesystem::path scene;
  /// Device files and trackers instead of the scene's: "FILE" for the only finger, "NAME=FILE"
  /// where the text before the first = is the name of a finger in the scene.
  std::vector<std::string> devices;
  std::vector<std::string> trackers;
  /// Person file: sizes of the fingers, and where the bodies that trackers follow sit on them.
  std::optional<std::filesystem::path> person;
  bool person_may_be_new = false;  ///< no such file yet: nothing is known of the person
  /// Finger file of whom the device is on, as far as it is emulated; empty: the simulated finger.
  std::optional<std::filesystem::path> wearer;
  /// How an emulated device sits on the wearer otherwise than its file says, see
  /// DeviceSettings::mount_fit; only with `wearer`.
  std::optional<Pose> wearer_mount;
  LoadObserver load_observer;
};

/// What to run, as a user says it.
struct RunOptions : SetupOptions {
  PoseConditioning conditioning;     ///< of all tracked poses
  std::optional<double> duration;    ///< s; empty: until the trackers end
  bool as_fast_as_possible = false;  ///< headless only: not paced by the wall clock
  /// Instead of the device files' (null).
  const ObjectiveKind* objective = nullptr;
  /// Of every device: its port, its guard, whether it may be absent. The run knows the rest.
  ActuatorOptions actuator;
  /// That step several fingers side by side, or one with a large mesh; the bits do not depend on
  /// it.
  int threads = 1;
  /// Live only: a second finger is pressed by the first one's device, for the page, which shows the
  /// first.
  bool twin = true;
  /// Each of these stops all devices, or asks to release them; null: nothing does.
  const StopSignals* stop_signals = nullptr;
  std::optional<std::filesystem::path> recording;
  bool record_state = false;
  std::optional<std::string> events;  ///< where events of objects are sent to, see EventSender
};

/// A scene with all it names loaded; what a run, a replay and the library start from.
struct RunSetup {
  Scene scene;                                             ///< overrides applied
  std::vector<std::shared_ptr<const FingerModel>> models;  ///< one per finger
  std::vector<std::shared_ptr<const Device>> devices;      ///< one per finger; null: none
  /// One per finger: its device as it sits on `wearer`, where what is known of a person says that
  /// it sits otherwise on the model; null: the same.
  std::vector<std::shared_ptr<const Device>> worn;
  /// One per finger: how far its device may be advanced; null: its force has no limit.
  std::vector<std::shared_ptr<const TravelCeiling>> ceilings;
  /// One per finger: what people must know of its device.
  std::vector<std::vector<DeviceNotice>> notices;
  /// Whom emulated force sensors press; null: the simulated fingers.
  std::shared_ptr<const FingerModel> wearer;
  std::optional<Person> person;
  /// One per finger: X_BodyFt of what its tracker follows; empty: the finger itself.
  std::vector<std::optional<Pose>> registrations;
  /// One per finger: what a file in its tracker's name is relative to.
  std::vector<std::filesystem::path> tracker_directories;
};

/// Reads the scene and every file it names. Throws InputError, also where its
/// observer asks for an end.
[[nodiscard]] std::shared_ptr<const RunSetup> load_setup(const SetupOptions& options);

/// The same with this finger alone.
[[nodiscard]] std::shared_ptr<const RunSetup> only_finger(const RunSetup& setup,
                                                          std::size_t finger);

/// The chain of this finger, as far as the files say it, with its device driven as `actuator` says;
/// `setup` must outlive the chain.
[[nodiscard]] FingerChainOptions chain_options(const RunSetup& setup, std::size_t finger,
                                               const ActuatorOptions& actuator);

/// Whether a registration of this finger has a person to be of and a tracked body: `script` and
/// `page` move the finger itself.
[[nodiscard]] bool is_registrable(const RunSetup& setup, std::size_t finger);

/// Whether this finger's device can learn who wears it: there is a person to be of, and it advances
/// and has a force sensor.
[[nodiscard]] bool is_fittable(const RunSetup& setup, std::size_t finger);

/// Of objects, then of fingers, as events number them.
[[nodiscard]] std::vector<std::string> names_in_events(const RunSetup& setup);

/// What a recording says of this setup; reads the files once more.
[[nodiscard]] RecordingInfo recording_info(const RunSetup& setup);

}  // namespace softfinger
