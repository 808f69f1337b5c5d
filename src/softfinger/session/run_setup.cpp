#include "softfinger/session/run_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "softfinger/base/error.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/base/stop_check.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/twin/skin_comparison.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// Part of a model's pad that a wearer's skin has to cover; with less it is not the same finger's.
constexpr double kLeastPad = 0.5;

/// Calls set(finger, value) for each "[NAME=]VALUE".
template <typename Set>
void apply_overrides(const std::vector<std::string>& overrides, const char* flag, Scene& scene,
                     const Set& set) {
  for (const std::string& text : overrides) {
    std::size_t finger = 0;
    std::string value = text;
    const std::size_t equals = text.find('=');
    bool named = false;
    if (equals != std::string::npos) {
      for (std::size_t i = 0; i < scene.fingers.size() && !named; ++i) {
        if (scene.fingers[i].name != text.substr(0, equals)) continue;
        named = true;
        finger = i;
        value = text.substr(equals + 1);
      }
    }
    if (!named && scene.fingers.size() > 1) {
      std::vector<std::string> names;
      for (const SceneFinger& each : scene.fingers) names.push_back(each.name);
      throw InputError(
          fmt::format("{} {}: the scene has several fingers, give NAME=... with one of "
                      "{}",
                      flag, text, fmt::join(names, ", ")));
    }
    set(finger, value);
  }
}

/// There is nothing to override in a scene of objects alone.
void refuse_without_finger(const std::vector<std::string>& overrides, const char* flag,
                           const Scene& scene) {
  if (overrides.empty() || !scene.fingers.empty()) return;
  throw InputError(fmt::format("{} {}: {} has no finger; leave it out", flag, overrides.front(),
                               scene.file.string()));
}

/// As `--tracker` says; a whole hand without a name moves every finger.
void override_trackers(const std::vector<std::string>& overrides, RunSetup& setup) {
  std::vector<std::string> named;
  for (const std::string& text : overrides) {
    const bool nameless = text == "webxr" || text.starts_with("webxr:");
    if (!nameless || !tracks_whole_hand(text)) {
      named.push_back(text);
      continue;
    }
    for (const SceneFinger& finger : setup.scene.fingers) named.push_back(finger.name + '=' + text);
  }
  apply_overrides(named, "--tracker", setup.scene, [&](std::size_t i, const std::string& spec) {
    setup.scene.fingers[i].tracker = spec;
    setup.tracker_directories[i].clear();
  });
  for (SceneFinger& finger : setup.scene.fingers) {
    finger.tracker = tracker_of_finger(finger.tracker, finger.name);
    if (finger.hand >= 0 && parse_tracker_spec(finger.tracker).kind == TrackerKind::kWebXr) {
      leave_to_headset(setup.scene, static_cast<std::size_t>(finger.hand));
    }
  }
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", file.string()));
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// What the model's pad feels the wearer's must have the skin to feel.
void check_pad(const FingerModel& wearer, const FingerModel& model) {
  const PadCover cover = pad_cover(model, wearer);
  if (cover.covered >= kLeastPad * cover.pad) return;
  throw InputError(fmt::format(
      "{}: its skin covers {:.0f} of the {:.0f} mm2 of the pad of {}, sizes aside; its group skin "
      "has to reach over the pad, which faces -z",
      wearer.file.string(), cover.covered / mm2, cover.pad / mm2, model.file.string()));
}

/// A misspelt name would leave a finger as it is in silence.
void check_names(const Person& person, const Scene& scene) {
  std::vector<std::string> known{"thumb", "index", "middle", "ring", "pinky"};
  for (const SceneFinger& finger : scene.fingers) known.push_back(finger.name);
  for (const PersonFinger& finger : person.fingers) {
    if (std::ranges::find(known, finger.name) != known.end()) continue;
    std::vector<std::string> names;
    for (const SceneFinger& each : scene.fingers) names.push_back(each.name);
    ConfigFile(person.file, person.text)
        .root()
        .fail(finger.name, fmt::format("neither a finger of a hand (thumb, index, middle, ring, "
                                       "pinky) nor of {}, which has {}",
                                       scene.file.string(), fmt::join(names, ", ")));
  }
}

/// Waypoints and the live page move the finger itself.
bool follows_body(const SceneFinger& finger) {
  return row_of(kTrackers, parse_tracker_spec(finger.tracker).kind).of_body;
}

/// As far as it is known of a person; null: nothing.
std::shared_ptr<const FingerModel> model_of(const fs::path& file, const PersonFinger* known) {
  if (known == nullptr) return FingerModel::load(file);
  return FingerModel::load(file, known->size, known->modulus_factor.value_or(1.0));
}

/// The device as it really sits: as its file says it does on a finger of the finger file's size.
std::shared_ptr<const Device> on_wearer(const SetupOptions& options, const SceneFinger& finger) {
  const auto device = mounted_on(*FingerModel::load(finger.model), *finger.device);
  return options.wearer_mount ? device->mounted(*options.wearer_mount) : device;
}

fs::path absolute_path(const fs::path& file) { return fs::absolute(file).lexically_normal(); }

}  // namespace

std::shared_ptr<const RunSetup> load_setup(const SetupOptions& options) {
  auto setup = std::make_shared<RunSetup>();
  setup->scene = load_scene(file_or_shipped(Shipped::kScene, options.scene.native()),
                            !options.trackers.empty(), options.load_observer);
  Scene& scene = setup->scene;
  refuse_without_finger(options.devices, "--device", scene);
  refuse_without_finger(options.trackers, "--tracker", scene);
  setup->tracker_directories.assign(scene.fingers.size(), scene.file.parent_path());
  apply_overrides(options.devices, "--device", scene, [&](std::size_t i, const std::string& file) {
    scene.fingers[i].device = file_or_shipped(Shipped::kDevice, file);
  });
  override_trackers(options.trackers, *setup);
  if (options.person) {
    setup->person = options.person_may_be_new ? load_person_if_any(*options.person)
                                              : load_person(*options.person);
    check_names(*setup->person, scene);
  }
  const std::stop_token& stop = options.load_observer.stop;
  for (const SceneFinger& finger : scene.fingers) {
    StopCheck::now(stop);
    const PersonFinger* known = setup->person ? setup->person->find(finger.name) : nullptr;
    setup->models.push_back(model_of(finger.model, known));
    setup->registrations.push_back(known != nullptr && follows_body(finger) ? known->X_BodyFt
                                                                            : std::nullopt);
    WornDevice worn;
    const bool fitted = known != nullptr && known->mount;
    if (finger.device && fitted) {
      const auto nominal = FingerModel::load(finger.model);
      worn = fitted_on(*setup->models.back(), *nominal, *finger.device, *known->mount, stop);
    } else if (finger.device) {
      worn = worn_on(*setup->models.back(), *finger.device, stop);
    }
    setup->worn.push_back(options.wearer && finger.device && (fitted || options.wearer_mount)
                              ? on_wearer(options, finger)
                              : nullptr);
    setup->devices.push_back(std::move(worn.device));
    setup->ceilings.push_back(std::move(worn.ceiling));
    setup->notices.push_back(std::move(worn.notices));
  }
  if (options.wearer) {
    setup->wearer = FingerModel::load(file_or_shipped(Shipped::kFinger, options.wearer->native()));
    for (const auto& model : setup->models) check_pad(*setup->wearer, *model);
  }
  return setup;
}

std::shared_ptr<const RunSetup> only_finger(const RunSetup& setup, std::size_t finger) {
  auto alone = std::make_shared<RunSetup>(setup);
  alone->scene.fingers = {setup.scene.fingers[finger]};
  alone->models = {setup.models[finger]};
  alone->devices = {setup.devices[finger]};
  alone->worn = {setup.worn[finger]};
  alone->ceilings = {setup.ceilings[finger]};
  alone->notices = {setup.notices[finger]};
  alone->registrations = {setup.registrations[finger]};
  alone->tracker_directories = {setup.tracker_directories[finger]};
  return alone;
}

bool is_registrable(const RunSetup& setup, std::size_t finger) {
  return setup.person && finger < setup.scene.fingers.size() &&
         follows_body(setup.scene.fingers[finger]);
}

bool is_fittable(const RunSetup& setup, std::size_t finger) {
  if (!setup.person || finger >= setup.devices.size()) return false;
  const Device* const device = setup.devices[finger].get();
  return device != nullptr && device->advances();
}

FingerChainOptions chain_options(const RunSetup& setup, std::size_t finger,
                                 const ActuatorOptions& actuator) {
  FingerChainOptions options{.finger = static_cast<std::int64_t>(finger),
                             .model = setup.models[finger],
                             .objects = setup.scene.objects,
                             .simulation_rate = setup.scene.simulation_rate,
                             .hand = setup.scene.fingers[finger].hand,
                             .device = setup.devices[finger]};
  options.device_loop.actuator = actuator;
  options.device_loop.actuator.ceiling = setup.ceilings[finger];
  if (const auto& file = setup.scene.fingers[finger].device) {
    options.device_loop.actuator.device_file = *file;
  }
  options.device_loop.wearer = setup.wearer;
  options.device_loop.worn = setup.worn[finger];
  return options;
}

std::vector<std::string> names_in_events(const RunSetup& setup) {
  std::vector<std::string> names;
  for (const VirtualObject& object : setup.scene.objects) names.push_back(object.name);
  for (const SceneFinger& finger : setup.scene.fingers) names.push_back(finger.name);
  return names;
}

RecordingInfo recording_info(const RunSetup& setup) {
  RecordingInfo info;
  info.program_version = SOFTFINGER_VERSION;
  info.instruction_set = name_of(active_instruction_set());
  info.scene = absolute_path(setup.scene.file);
  info.simulation_rate = setup.scene.simulation_rate;
  const auto add_file = [&](const fs::path& file) {
    info.files.push_back({absolute_path(file), content_of(file)});
  };
  add_file(setup.scene.file);
  if (setup.person) {
    info.person = absolute_path(setup.person->file);
    info.files.push_back({info.person, setup.person->text});
  }
  for (std::size_t i = 0; i < setup.scene.fingers.size(); ++i) {
    const SceneFinger& scene_finger = setup.scene.fingers[i];
    RecordingInfo::Finger finger;
    finger.name = scene_finger.name;
    finger.model = absolute_path(scene_finger.model);
    finger.tracker = scene_finger.tracker;
    add_file(scene_finger.model);
    add_file(ConfigFile(scene_finger.model).root().table("mesh").path("file"));
    if (const Device* device = setup.devices[i].get()) {
      finger.device = absolute_path(*scene_finger.device);
      finger.joints = device->joint_count();
      finger.linear_joints = device->joint_limits().linear;
      finger.device_rate = device_rate(*device);
      if (const auto& transport = device->settings().transport) {
        finger.servo_unit = transport->unit;
        finger.servo_step = transport->servos.front().step / transport->unit_scale;
      }
      for (const ConfigurationAxis& axis : device->axes()) {
        finger.configuration_names.push_back(axis.name);
      }
      add_file(*scene_finger.device);
    }
    info.fingers.push_back(std::move(finger));
  }
  for (const VirtualObject& object : setup.scene.objects) {
    if (object.soft) add_file(object.soft->file);
    if (object.moves_by_forces()) {
      const auto joint = object.dynamics ? object.dynamics->joint : std::nullopt;
      const char* unit = "";
      if (joint && joint->kind == JointKind::kSlider) unit = "mm";
      if (joint && joint->kind == JointKind::kHinge) unit = "deg";
      info.objects.push_back({&object - setup.scene.objects.data(), object.name, unit});
    }
    info.object_names.push_back(object.name);
    if (const auto* mesh = std::get_if<MeshShape>(&object.shape)) {
      info.meshes.push_back({absolute_path((*mesh)->source()), (*mesh)->source_hash()});
    }
  }
  return info;
}

}  // namespace softfinger
