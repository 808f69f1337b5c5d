#include "softfinger/rendering.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "softfinger/actuation/device_state.hpp"
#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/frames.hpp"
#include "softfinger/c_interface/guard_beside_library.hpp"
#include "softfinger/c_interface/held_rendering.hpp"

namespace softfinger {
namespace {

// What the structs were when they were first published: whoever was compiled then still runs.
constexpr std::size_t kFirstOptions = offsetof(sf_options, guard_program);
constexpr std::size_t kFirstCommand = offsetof(sf_command, stopped);
constexpr std::size_t kComponents = std::extent_v<decltype(sf_command::configuration)>;

/// s; steps up to then can be counted.
constexpr double kLatest = 1e12;
/// Bytes; a pose that says it is larger than any will ever be has no size.
constexpr std::size_t kLargestPose = 1024;

struct NamedState {
  std::string_view name;
  sf_state state;
};
constexpr std::array<NamedState, kDeviceStates.size()> kStates{{
    {state_name(DeviceState::kDisconnected), SF_DISCONNECTED},
    {state_name(DeviceState::kHoming), SF_HOMING},
    {state_name(DeviceState::kReady), SF_READY},
    {state_name(DeviceState::kRendering), SF_RENDERING},
    {state_name(DeviceState::kHolding), SF_HOLDING},
    {state_name(DeviceState::kRetracting), SF_RETRACTING},
    {state_name(DeviceState::kStopped), SF_STOPPED},
}};

sf_state c_state(std::string_view name) {
  for (const NamedState& row : kStates) {
    if (row.name == name) return row.state;
  }
  return SF_DISCONNECTED;  // no device
}

std::uint32_t c_count(const Eigen::VectorXd& values) {
  return static_cast<std::uint32_t>(values.size());
}

/// The options by name, as whoever set `size` knew them.
RenderingOptions rendering_options(const sf_options* given) {
  const sf_options options = taken(given, kFirstOptions, "sf_options");
  RenderingOptions named;
  const auto name = [](auto& to, const char* text) {
    if (text != nullptr) to = text;
  };
  name(named.finger, options.finger);
  name(named.device, options.device);
  name(named.person, options.person);
  name(named.recording, options.recording);
  named.guard_program =
      options.guard_program != nullptr ? options.guard_program : guard_beside_library();
  named.open_device = options.open_device != 0;
  named.all_fingers = options.all_fingers != 0;
  if (options.threads != 0) named.threads = options.threads;
  named.record_state = options.record_state != 0;
  named.filter = options.filter != 0;
  if (options.predict_s != 0.0) named.predict = options.predict_s;
  return named;
}

void check(std::size_t count, std::size_t most, const char* what) {
  if (count <= most) return;
  throw InputError(
      fmt::format("the device has {} {}: sf_command holds at most {}", count, what, most));
}

void copy_values(const Eigen::VectorXd& values, double* out) {
  std::copy_n(values.data(), values.size(), out);
}

void tell_command(const RenderingCommand& from, sf_command* out) {
  if (out == nullptr) return;
  // Written in place: it is large, and a step should not be slower for it.
  const std::uint32_t size = out->size;
  const bool has_newer = size >= sizeof(sf_command);
  std::memset(out, 0, has_newer ? sizeof(sf_command) : kFirstCommand);
  out->size = size;
  out->configuration_count = c_count(from.configuration);
  out->joint_count = c_count(from.joints);
  out->state = c_state(from.state);
  out->tick = from.tick;
  out->time_s = from.time;
  out->deviation_m2 = from.deviation;
  copy_values(from.configuration, out->configuration);
  copy_values(from.joints, out->joints);
  if (!has_newer) return;
  out->stopped = from.stopped ? 1 : 0;
  out->stop_confirmed = from.stop_confirmed ? 1 : 0;
  out->stops = from.stops;
  out->set_point_count = c_count(from.set_points);
  copy_values(from.set_points, out->set_points);
}

sf_status check_command(const RenderingUse& use, const sf_command* out) {
  if (out == nullptr || out->size >= kFirstCommand) return SF_DONE;
  return use.refuse("sf_command.size must be sizeof(sf_command)");
}

/// One step with use->poses; one that is none: lost tracking.
sf_status advance_all(const RenderingUse& use, double time) {
  if (!(std::abs(time) <= kLatest)) return use.refuse("time_s must be from -1e12 to 1e12");
  if (time < use->time) {
    return use.refuse("time_s goes back: it must not be less than at the call before");
  }
  use->time = time;
  use->fresh = false;
  use->rendering.step(use->poses, time);
  return SF_DONE;
}

/// The same of the one finger that there is, or with none of all.
sf_status advance(const RenderingUse& use, const std::optional<Pose>& X_WFt, double time,
                  sf_command* out) {
  if (const sf_status status = check_command(use, out); status != SF_DONE) return status;
  if (X_WFt && use->poses.size() != 1) {
    return use.refuse(
        "there are several fingers: sf_rendering_step_fingers() takes a pose for each");
  }
  std::fill(use->poses.begin(), use->poses.end(), X_WFt);
  const sf_status status = advance_all(use, time);
  if (status == SF_DONE) tell_command(use->rendering.command(use->selected), out);
  return status;
}

}  // namespace

HeldRendering::HeldRendering(const char* scene, const sf_options* options)
    : rendering(scene, rendering_options(options)),
      fingers(rendering.finger_names()),
      objects(rendering.object_names()),
      poses(fingers.size()) {
  for (std::size_t finger = 0; finger < fingers.size(); ++finger) {
    components.push_back(rendering.configuration_names(finger));
    check(components.back().size(), kComponents, "components");
  }
  rendering.snapshot(snapshot);
}

}  // namespace softfinger

using softfinger::RenderingUse;

sf_status sf_rendering_create(const char* scene, const sf_options* options, sf_rendering** out,
                              char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (scene == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "scene and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_rendering(std::make_unique<softfinger::HeldRendering>(scene, options));
    return SF_DONE;
  });
}

void sf_rendering_destroy(sf_rendering* rendering) {
  if (rendering != nullptr) rendering->destroy();
}

sf_status sf_rendering_message(const sf_rendering* rendering, char* text, size_t capacity) {
  softfinger::copy_text(sf_rendering::message(rendering), text, capacity, nullptr);
  return SF_DONE;
}

sf_status sf_rendering_step(sf_rendering* rendering, const sf_pose* X_WFt, double time_s,
                            sf_command* out) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (X_WFt == nullptr) return use.refuse("X_WFt must not be NULL; sf_rendering_lost() says so");
  if (X_WFt->size < sizeof(sf_pose)) return use.refuse("sf_pose.size must be sizeof(sf_pose)");
  const std::optional<softfinger::Pose> pose = softfinger::pose_of(*X_WFt);
  const sf_status status = softfinger::advance(use, pose, time_s, out);
  if (status != SF_DONE || pose) return status;
  return use.refuse(
      "X_WFt: must be within 1000 m, the quaternion's norm 1; taken as lost tracking");
}

sf_status sf_rendering_step_matrix(sf_rendering* rendering, const double X_WFt[16], double time_s,
                                   sf_command* out) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (X_WFt == nullptr) return use.refuse("X_WFt must not be NULL; sf_rendering_lost() says so");
  double matrix[16];
  std::copy_n(X_WFt, 16, matrix);
  const std::optional<softfinger::Pose> pose = softfinger::pose_of(matrix);
  const sf_status status = softfinger::advance(use, pose, time_s, out);
  if (status != SF_DONE || pose) return status;
  return use.refuse(
      "X_WFt: must be a rotation and a translation within 1000 m over 0 0 0 1; taken as lost "
      "tracking");
}

sf_status sf_rendering_lost(sf_rendering* rendering, double time_s, sf_command* out) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  return use ? softfinger::advance(use, std::nullopt, time_s, out) : SF_BAD_INPUT;
}

sf_status sf_rendering_step_fingers(sf_rendering* rendering, const sf_pose* X_WFt,
                                    const int32_t* tracked, size_t count, double time_s) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (count != use->poses.size()) return use.refuse("count must be the number of fingers");
  if (X_WFt == nullptr) return use.refuse("X_WFt must not be NULL; sf_rendering_lost() says so");
  const std::size_t size = X_WFt->size;
  if (size < sizeof(sf_pose) || size > softfinger::kLargestPose) {
    return use.refuse("sf_pose.size must be sizeof(sf_pose)");
  }
  bool all_are_poses = true;
  for (std::size_t i = 0; i < count; ++i) {
    use->poses[i].reset();
    if (tracked != nullptr && tracked[i] == 0) continue;
    sf_pose pose;
    std::memcpy(&pose, reinterpret_cast<const char*>(X_WFt) + i * size, sizeof pose);
    use->poses[i] = softfinger::pose_of(pose);
    all_are_poses = all_are_poses && use->poses[i];
  }
  const sf_status status = softfinger::advance_all(use, time_s);
  if (status != SF_DONE || all_are_poses) return status;
  return use.refuse(
      "X_WFt: must be within 1000 m, the quaternion's norm 1; taken as lost tracking");
}

sf_status sf_rendering_move_object(sf_rendering* rendering, size_t object, const sf_pose* X_WO) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (object >= use->objects.size()) return use.refuse("object: must be less than object_count");
  if (X_WO == nullptr || X_WO->size < sizeof(sf_pose)) {
    return use.refuse("X_WO.size must be sizeof(sf_pose)");
  }
  const std::optional<softfinger::Pose> pose = softfinger::pose_of(*X_WO);
  if (!pose) return use.refuse("X_WO: must be within 1000 m, the quaternion's norm 1");
  return softfinger::guarded({nullptr, 0}, [&] {
    try {
      use->rendering.move_object(object, *pose);
    } catch (const softfinger::InputError&) {
      return use.refuse(
          "the object moves by forces, or something hangs on it by a joint, or a recording is "
          "made: "
          "it cannot be moved from outside");
    }
    return SF_DONE;
  });
}

sf_status sf_rendering_select(sf_rendering* rendering, size_t finger) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (finger >= use->fingers.size()) {
    return use.refuse("finger must be less than the number of fingers");
  }
  use->fresh = use->fresh && use->selected == finger;
  use->selected = finger;
  return SF_DONE;
}

sf_status sf_rendering_command(const sf_rendering* rendering, sf_command* out) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (out == nullptr) return use.refuse("sf_command.size must be sizeof(sf_command)");
  const sf_status status = softfinger::check_command(use, out);
  if (status == SF_DONE) softfinger::tell_command(use->rendering.command(use->selected), out);
  return status;
}

sf_status sf_rendering_stop(sf_rendering* rendering) {
  const RenderingUse use(rendering, RenderingUse::kAnyThread);
  if (!use) return SF_BAD_INPUT;
  use->rendering.stop();
  return SF_DONE;
}

sf_status sf_rendering_release(sf_rendering* rendering) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (use->rendering.release()) return SF_DONE;
  return use.fail("nothing is stopped, or it was stopped again since the last step");
}

sf_status sf_rendering_take_message(sf_rendering* rendering, char* text, size_t capacity,
                                    size_t* count) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  return softfinger::guarded({nullptr, 0}, [&] {
    softfinger::copy_text(use->rendering.take_message().value_or(""), text, capacity, count);
    return SF_DONE;
  });
}

sf_status sf_rendering_close_recording(sf_rendering* rendering, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return text.tell(SF_BAD_INPUT, use.wrong());
  return softfinger::guarded(text, [&] {
    use->rendering.close_recording();
    return SF_DONE;
  });
}
