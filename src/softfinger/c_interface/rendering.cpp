#include "softfinger/rendering.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "softfinger/actuation/device_state.hpp"
#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/frames.hpp"
#include "softfinger/c_interface/guard_beside_library.hpp"
#include "softfinger/c_interface/handle.hpp"
#include "softfinger/recording/record.hpp"

namespace softfinger {
namespace {

// What the structs were when they were first published: whoever was compiled then still runs.
constexpr std::size_t kFirstOptions = offsetof(sf_options, guard_program);
constexpr std::size_t kFirstCommand = offsetof(sf_command, stopped);
constexpr std::size_t kFirstInfo = offsetof(sf_info, finger_count);
constexpr std::size_t kFirstContact = offsetof(sf_contact, normal_force_sum_N);
constexpr std::size_t kComponents = std::extent_v<decltype(sf_command::configuration)>;

/// s; steps up to then can be counted.
constexpr double kLatest = 1e12;

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

struct NamedKind {
  const char* name;
  sf_event_kind kind;
};
sf_state c_state(std::string_view name) {
  for (const NamedState& row : kStates) {
    if (row.name == name) return row.state;
  }
  return SF_DISCONNECTED;  // no device
}

constexpr std::array<NamedKind, kEventKinds.size()> kKinds{{{kEventKinds[0], SF_IMPACT},
                                                            {kEventKinds[1], SF_RELEASE},
                                                            {kEventKinds[2], SF_CLICK},
                                                            {kEventKinds[3], SF_DETENT},
                                                            {kEventKinds[4], SF_LIMIT}}};

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

}  // namespace

/// A rendering and what its calls leave between them.
struct HeldRendering {
  HeldRendering(const char* scene, const sf_options* options)
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

  static void check(std::size_t count, std::size_t most, const char* what) {
    if (count <= most) return;
    throw InputError(
        fmt::format("the device has {} {}: sf_command holds at most {}", count, what, most));
  }

  const RenderingSnapshot& newest() {
    if (!fresh) rendering.snapshot(snapshot, selected);
    fresh = true;
    return snapshot;
  }

  Rendering rendering;
  std::vector<std::string> fingers, objects;
  std::vector<std::vector<std::string>> components;        ///< of each finger's configuration
  std::vector<std::optional<Pose>> poses;                  ///< of each, of the call under way
  std::size_t selected = 0;                                ///< finger that is told of
  std::vector<Vector3> surface;                            ///< of the object asked for last
  double time = -std::numeric_limits<double>::infinity();  ///< of the last call, s
  RenderingSnapshot snapshot;
  bool fresh = true;
};

namespace {

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

}  // namespace
}  // namespace softfinger

struct sf_rendering : softfinger::Handle<softfinger::HeldRendering> {
  using Handle::Handle;
};

namespace softfinger {
namespace {

using RenderingUse = Handle<HeldRendering>::Use;

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

bool checks_object(const RenderingUse& use, std::size_t object) {
  if (object < use->objects.size()) return true;
  (void)use.refuse("object must be less than the number of objects");
  return false;
}

void copy_triangles(const std::vector<std::array<int, 3>>& triangles, std::uint32_t* corners,
                    std::size_t capacity, std::size_t* count) {
  const std::size_t written = corners == nullptr ? 0 : std::min(capacity, triangles.size());
  for (std::size_t i = 0; i < written; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners[3 * i + k] = static_cast<std::uint32_t>(triangles[i][k]);
    }
  }
  if (count != nullptr) *count = triangles.size();
}

void copy_points(const std::vector<Vector3>& points, double* xyz, std::size_t capacity,
                 std::size_t* count) {
  const std::size_t written = xyz == nullptr ? 0 : std::min(capacity, points.size());
  for (std::size_t i = 0; i < written; ++i) std::copy_n(points[i].data(), 3, xyz + 3 * i);
  if (count != nullptr) *count = points.size();
}

/// A reading call: `read` gets the snapshot after the last step.
template <typename Read>
sf_status with_snapshot(const sf_rendering* handle, Read&& read) {
  const RenderingUse use(handle, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  return guarded({nullptr, 0}, [&] { return read(use, use->newest()); });
}

sf_status tell_name(const RenderingUse& use, const std::vector<std::string>& names,
                    std::size_t index, char* name, std::size_t capacity, std::size_t* count) {
  if (index >= names.size()) return use.refuse("the index must be less than their number");
  copy_text(names[index], name, capacity, count);
  return SF_DONE;
}

}  // namespace
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
  if (size < sizeof(sf_pose)) return use.refuse("sf_pose.size must be sizeof(sf_pose)");
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

sf_status sf_rendering_info(const sf_rendering* rendering, sf_info* out) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto& snapshot) {
    if (out == nullptr || out->size < softfinger::kFirstInfo) {
      return use.refuse("sf_info.size must be sizeof(sf_info)");
    }
    const std::size_t finger = use->selected;
    sf_info info{};
    info.sample_count = static_cast<std::uint32_t>(snapshot.in_contact.size());
    info.triangle_count = static_cast<std::uint32_t>(use->rendering.skin_triangles(finger).size());
    info.object_count = static_cast<std::uint32_t>(use->objects.size());
    info.configuration_count = static_cast<std::uint32_t>(use->components[finger].size());
    info.joint_count = static_cast<std::uint32_t>(use->rendering.joint_count(finger));
    info.simulation_rate_Hz = use->rendering.simulation_rate();
    info.device_rate_Hz = use->rendering.device_rate(finger);
    info.finger_count = static_cast<std::uint32_t>(use->fingers.size());
    softfinger::hand_out(info, out);
    return SF_DONE;
  });
}

sf_status sf_rendering_contact(const sf_rendering* rendering, sf_contact* out) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto& snapshot) {
    if (out == nullptr || out->size < softfinger::kFirstContact) {
      return use.refuse("sf_contact.size must be sizeof(sf_contact)");
    }
    sf_contact contact{};
    contact.samples_in_contact = static_cast<std::uint32_t>(snapshot.contact_count);
    contact.time_s = snapshot.time;
    contact.normal_force_N = snapshot.normal_force;
    contact.tangential_force_N = snapshot.tangential_force;
    contact.contact_area_m2 = snapshot.contact_area;
    std::copy_n(snapshot.centroid_F.data(), 3, contact.centroid_F_m);
    std::copy_n(snapshot.mean_normal_F.data(), 3, contact.mean_normal_F);
    contact.normal_force_sum_N = snapshot.normal_force_sum;
    contact.slip_ratio = snapshot.slip_ratio;
    softfinger::hand_out(contact, out);
    return SF_DONE;
  });
}

sf_status sf_rendering_poses(const sf_rendering* rendering, sf_pose* X_WFt, sf_pose* X_WF) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto& snapshot) {
    for (const sf_pose* pose : {X_WFt, X_WF}) {
      if (pose != nullptr && pose->size < sizeof(sf_pose)) {
        return use.refuse("sf_pose.size must be sizeof(sf_pose)");
      }
    }
    if (X_WFt != nullptr) softfinger::hand_out(softfinger::c_pose(snapshot.X_WFt), X_WFt);
    if (X_WF != nullptr) softfinger::hand_out(softfinger::c_pose(snapshot.X_WF), X_WF);
    return SF_DONE;
  });
}

sf_status sf_rendering_positions(const sf_rendering* rendering, double* xyz_F_m, size_t capacity,
                                 size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse&, const auto& snapshot) {
    softfinger::copy_points(snapshot.sample_positions_F, xyz_F_m, capacity, count);
    return SF_DONE;
  });
}

sf_status sf_rendering_pressures(const sf_rendering* rendering, double* pressures_Pa,
                                 size_t capacity, size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse&, const auto& snapshot) {
    const auto& pressures = snapshot.sample_pressures;
    softfinger::copy_out(pressures.size(), pressures_Pa, capacity, count,
                         [&](std::size_t i) { return pressures[i]; });
    return SF_DONE;
  });
}

sf_status sf_rendering_in_contact(const sf_rendering* rendering, uint8_t* in_contact,
                                  size_t capacity, size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse&, const auto& snapshot) {
    softfinger::copy_out(
        snapshot.in_contact.size(), in_contact, capacity, count,
        [&](std::size_t i) -> std::uint8_t { return snapshot.in_contact[i] ? 1 : 0; });
    return SF_DONE;
  });
}

sf_status sf_rendering_triangles(const sf_rendering* rendering, uint32_t* corners, size_t capacity,
                                 size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto&) {
    softfinger::copy_triangles(use->rendering.skin_triangles(use->selected), corners, capacity,
                               count);
    return SF_DONE;
  });
}

sf_status sf_rendering_object_pose(const sf_rendering* rendering, size_t object, sf_pose* X_WO) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto& snapshot) {
    if (!softfinger::checks_object(use, object)) return SF_BAD_INPUT;
    if (X_WO == nullptr || X_WO->size < sizeof(sf_pose)) {
      return use.refuse("sf_pose.size must be sizeof(sf_pose)");
    }
    softfinger::hand_out(softfinger::c_pose(snapshot.X_WO[object]), X_WO);
    return SF_DONE;
  });
}

sf_status sf_rendering_object_name(const sf_rendering* rendering, size_t object, char* name,
                                   size_t capacity, size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto&) {
    return softfinger::tell_name(use, use->objects, object, name, capacity, count);
  });
}

sf_status sf_rendering_object(const sf_rendering* rendering, size_t object, sf_object* out) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto& snapshot) {
    if (!softfinger::checks_object(use, object)) return SF_BAD_INPUT;
    if (out == nullptr || out->size < sizeof(sf_object)) {
      return use.refuse("sf_object.size must be sizeof(sf_object)");
    }
    const softfinger::RenderingObject& from = snapshot.objects[object];
    sf_object told{};
    told.moves = from.moves ? 1 : 0;
    told.has_joint = std::isnan(from.joint) ? 0 : 1;
    told.soft = use->rendering.object_triangles(object).empty() ? 0 : 1;
    told.joint = told.has_joint == 1 ? from.joint : 0.0;
    std::copy_n(from.velocity.data(), 3, told.velocity_m_per_s);
    std::copy_n(from.angular_velocity.data(), 3, told.angular_velocity_rad_per_s);
    softfinger::hand_out(told, out);
    return SF_DONE;
  });
}

sf_status sf_rendering_object_positions(const sf_rendering* rendering, size_t object,
                                        double* xyz_W_m, size_t capacity, size_t* count) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use || !softfinger::checks_object(use, object)) return SF_BAD_INPUT;
  return softfinger::guarded({nullptr, 0}, [&] {
    use->rendering.object_positions(object, use->surface);
    softfinger::copy_points(use->surface, xyz_W_m, capacity, count);
    return SF_DONE;
  });
}

sf_status sf_rendering_object_triangles(const sf_rendering* rendering, size_t object,
                                        uint32_t* corners, size_t capacity, size_t* count) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use || !softfinger::checks_object(use, object)) return SF_BAD_INPUT;
  softfinger::copy_triangles(use->rendering.object_triangles(object), corners, capacity, count);
  return SF_DONE;
}

sf_status sf_rendering_take_event(sf_rendering* rendering, sf_event* out) {
  const RenderingUse use(rendering, RenderingUse::kAlone);
  if (!use) return SF_BAD_INPUT;
  if (out == nullptr || out->size < sizeof(sf_event)) {
    return use.refuse("sf_event.size must be sizeof(sf_event)");
  }
  sf_event told{};
  told.other_object = -1;
  told.other_finger = -1;
  if (const auto event = use->rendering.take_event()) {
    for (const auto& row : softfinger::kKinds) {
      if (row.name == event->kind) told.kind = row.kind;
    }
    told.time_s = event->time;
    told.impulse_N_s = event->impulse;
    told.object = static_cast<std::uint32_t>(event->object);
    if (event->other_object) told.other_object = static_cast<std::int32_t>(*event->other_object);
    if (event->other_finger) told.other_finger = static_cast<std::int32_t>(*event->other_finger);
  }
  softfinger::hand_out(told, out);
  return SF_DONE;
}

const char* sf_event_text(sf_event_kind kind) {
  for (const auto& row : softfinger::kKinds) {
    if (row.kind == kind) return row.name;
  }
  return "";
}

sf_status sf_rendering_finger_name(const sf_rendering* rendering, size_t finger, char* name,
                                   size_t capacity, size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto&) {
    return softfinger::tell_name(use, use->fingers, finger, name, capacity, count);
  });
}

sf_status sf_rendering_configuration_name(const sf_rendering* rendering, size_t component,
                                          char* name, size_t capacity, size_t* count) {
  return softfinger::with_snapshot(rendering, [&](const RenderingUse& use, const auto&) {
    return softfinger::tell_name(use, use->components[use->selected], component, name, capacity,
                                 count);
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
