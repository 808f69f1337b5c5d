#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "softfinger/c_interface/frames.hpp"
#include "softfinger/c_interface/held_rendering.hpp"
#include "softfinger/recording/record.hpp"

// What a rendering tells, of the finger that is selected and of the objects.

namespace softfinger {
namespace {

// What the structs were when they were first published: whoever was compiled then still runs.
constexpr std::size_t kFirstInfo = offsetof(sf_info, finger_count);
constexpr std::size_t kFirstContact = offsetof(sf_contact, normal_force_sum_N);

struct NamedKind {
  const char* name;
  sf_event_kind kind;
};
constexpr std::array<NamedKind, kEventKinds.size()> kKinds{{{kEventKinds[0], SF_IMPACT},
                                                            {kEventKinds[1], SF_RELEASE},
                                                            {kEventKinds[2], SF_CLICK},
                                                            {kEventKinds[3], SF_DETENT},
                                                            {kEventKinds[4], SF_LIMIT}}};

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

}  // namespace
}  // namespace softfinger

using softfinger::RenderingUse;

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
