#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/handle.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/objectives/first_touch_match.hpp"
#include "softfinger/session/report/workspace_report.hpp"

namespace softfinger {

/// What sf_device holds.
struct HeldDevice {
  std::shared_ptr<const Device> device;
};

}  // namespace softfinger

struct sf_device : softfinger::Handle<softfinger::HeldDevice> {
  using Handle::Handle;
};

namespace softfinger {
namespace {

using DeviceUse = Handle<HeldDevice>::Use;

constexpr std::uint32_t kMostPoints = 100000;

/// A reading call on the device; `read` may throw.
template <typename Read>
sf_status with_device(const sf_device* handle, Read&& read) {
  const DeviceUse use(handle, DeviceUse::kAnyThread);
  if (!use) return SF_BAD_INPUT;
  return guarded({nullptr, 0}, [&] { return read(use, *use->device); });
}

bool are_finite(const double* values, std::size_t count) {
  return values != nullptr &&
         std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}

template <typename Vector>
Vector vector_of(const double* values, std::size_t count) {
  Vector vector(static_cast<Eigen::Index>(count));
  std::copy_n(values, count, vector.data());
  return vector;
}

/// What is wrong with the points; null: nothing.
const char* wrong_with(const sf_points& points) {
  const std::size_t count = points.count;
  if (points.size != sizeof(sf_points)) return "sf_points.size must be sizeof(sf_points)";
  if (count < 1 || count > kMostPoints) return "count: must be from 1 to 100000";
  if (!are_finite(points.points_F_m, 3 * count)) return "points_F_m: must be finite";
  if (points.in_contact == nullptr) return "in_contact: must not be NULL";
  if (points.areas_m2 != nullptr && !are_finite(points.areas_m2, count)) {
    return "areas_m2: must be finite";
  }
  if (points.gaps_m != nullptr && !are_finite(points.gaps_m, count)) {
    return "gaps_m: must be finite";
  }
  if (!(points.separation_m >= 0.0 && std::isfinite(points.separation_m))) {
    return "separation_m: must be 0 or more";
  }
  if (points.limits < 0 || points.limits > 2) return "limits: must be 0, 1 or 2";
  if (points.objective < 0 || points.objective > 2) return "objective: must be 0, 1 or 2";
  return nullptr;
}

MatchingOptions options_of(const sf_points& points) {
  MatchingOptions options;
  options.limits = static_cast<MatchingLimits>(points.limits);
  options.separation = points.gaps_m != nullptr ? Separation::kScene : Separation::kConstant;
  options.weights = points.areas_m2 != nullptr ? MatchingWeights::kArea : MatchingWeights::kUniform;
  if (points.separation_m > 0.0) options.separation_tolerance = points.separation_m;
  return options;
}

constexpr const char* kObjectives[] = {"surface", "published", "plane"};

struct Matched {
  MatchingResult result;
  std::string limits;  ///< names, separated by commas
};

Matched matched(const std::shared_ptr<const Device>& device, const sf_points& points) {
  const std::size_t count = points.count;
  std::vector<Vector3> points_F;
  std::vector<std::uint8_t> in_contact;
  for (std::size_t i = 0; i < count; ++i) {
    points_F.emplace_back(points.points_F_m + 3 * i);
    in_contact.push_back(points.in_contact[i] != 0 ? 1 : 0);
  }
  const auto given = [&](const double* values) {
    return values == nullptr ? std::span<const double>() : std::span(values, count);
  };
  ContactSurfaceMatching matching(device, static_cast<int>(count));
  const MatchingResult result =
      first_touch_match(*objective_kind(kObjectives[points.objective]), device,
                        {points_F, in_contact, given(points.areas_m2), given(points.gaps_m)},
                        options_of(points), matching);
  return {result, fmt::format("{}", fmt::join(matching.limit_names(result), ","))};
}

/// What is thrown has a line that goes; the handle keeps one of these.
constexpr const char* kCannotMatch =
    "the device cannot be matched so: \"published\" takes limits clamp or none and no gaps, "
    "\"plane\" a length in the configuration";

}  // namespace
}  // namespace softfinger

using softfinger::Device;
using softfinger::DeviceUse;

sf_status sf_device_create(const char* file, sf_device** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (file == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "file and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_device(std::make_unique<softfinger::HeldDevice>(softfinger::HeldDevice{
        softfinger::load_device(softfinger::file_or_shipped(softfinger::Shipped::kDevice, file))}));
    return SF_DONE;
  });
}

void sf_device_destroy(sf_device* device) {
  if (device != nullptr) device->destroy();
}

sf_status sf_device_message(const sf_device* device, char* text, size_t capacity) {
  softfinger::copy_text(sf_device::message(device), text, capacity, nullptr);
  return SF_DONE;
}

sf_status sf_device_describe(const sf_device* handle, sf_device_info* out) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (out == nullptr || out->size < sizeof(sf_device_info)) {
      return use.refuse("sf_device_info.size must be sizeof(sf_device_info)");
    }
    const softfinger::JointLimits& joints = device.joint_limits();
    softfinger::hand_out({sizeof *out, static_cast<std::uint32_t>(device.degrees_of_freedom()),
                          static_cast<std::uint32_t>(device.joint_count()), joints.linear ? 1 : 0},
                         out);
    return SF_DONE;
  });
}

sf_status sf_device_show(const sf_device* handle, char* text, size_t capacity, size_t* count) {
  return softfinger::with_device(handle, [&](const DeviceUse&, const Device& device) {
    softfinger::copy_text(device.settings().as_read, text, capacity, count);
    return SF_DONE;
  });
}

sf_status sf_device_component(const sf_device* handle, size_t component, char* name,
                              size_t capacity, double* unit) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (component >= device.axes().size()) {
      return use.refuse("component: must be less than their number");
    }
    softfinger::copy_text(device.axes()[component].name, name, capacity, nullptr);
    if (unit != nullptr) *unit = device.axes()[component].unit();
    return SF_DONE;
  });
}

sf_status sf_device_home(const sf_device* handle, double* configuration, size_t count) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (configuration == nullptr || count != static_cast<std::size_t>(device.home().size())) {
      return use.refuse("configuration: must have as many components as the device");
    }
    std::copy_n(device.home().data(), count, configuration);
    return SF_DONE;
  });
}

sf_status sf_device_solve(const sf_device* handle, const double* configuration,
                          size_t configuration_count, double* joints, size_t joint_count,
                          int32_t* closes, int32_t* reachable) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (configuration_count != device.axes().size() ||
        !softfinger::are_finite(configuration, configuration_count)) {
      return use.refuse("configuration: must be finite, with as many components as the device");
    }
    if (joints == nullptr || joint_count != static_cast<std::size_t>(device.joint_count())) {
      return use.refuse("joints: must have room for as many as the device has");
    }
    const auto q =
        softfinger::vector_of<softfinger::Configuration>(configuration, configuration_count);
    softfinger::JointAngles solved;
    const bool exist = device.inverse_kinematics(q, solved);
    std::fill_n(joints, joint_count, std::numeric_limits<double>::quiet_NaN());
    if (exist) std::copy_n(solved.data(), joint_count, joints);
    if (closes != nullptr) *closes = exist ? 1 : 0;
    if (reachable != nullptr) *reachable = device.reachable(q) ? 1 : 0;
    return SF_DONE;
  });
}

sf_status sf_device_pose(const sf_device* handle, const double* joints, size_t joint_count,
                         double* configuration, size_t configuration_count) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (joint_count != static_cast<std::size_t>(device.joint_count()) ||
        !softfinger::are_finite(joints, joint_count)) {
      return use.refuse("joints: must be finite, as many as the device has");
    }
    if (configuration == nullptr || configuration_count != device.axes().size()) {
      return use.refuse("configuration: must have room for as many components as the device has");
    }
    softfinger::Configuration q;
    if (!device.forward_kinematics(
            softfinger::vector_of<softfinger::JointAngles>(joints, joint_count), q)) {
      return use.fail("no configuration inside the workspace has these joints");
    }
    std::copy_n(q.data(), configuration_count, configuration);
    return SF_DONE;
  });
}

sf_status sf_device_match(const sf_device* handle, const sf_points* points, sf_match* out) {
  return softfinger::with_device(handle, [&](const DeviceUse& use, const Device& device) {
    if (points == nullptr) return use.refuse("points must not be NULL");
    if (out == nullptr || out->size < offsetof(sf_match, at_limit)) {
      return use.refuse("sf_match.size must be sizeof(sf_match)");
    }
    if (const char* wrong = softfinger::wrong_with(*points)) return use.refuse(wrong);
    softfinger::Matched matched;
    try {
      matched = softfinger::matched(use->device, *points);
    } catch (const softfinger::InputError&) {
      return use.refuse(softfinger::kCannotMatch);
    }
    const softfinger::MatchingResult& result = matched.result;
    sf_match match{};
    softfinger::copy_text(matched.limits, match.at_limit, sizeof match.at_limit, nullptr);
    match.configuration_count = static_cast<std::uint32_t>(result.configuration.size());
    match.joint_count = static_cast<std::uint32_t>(device.joint_count());
    match.joints_exist = result.joints_exist ? 1 : 0;
    match.iterations = result.iterations;
    match.termination = static_cast<std::int32_t>(result.termination);
    match.deviation_m2 = result.deviation;
    std::copy_n(result.configuration.data(), result.configuration.size(), match.configuration);
    if (result.joints_exist) std::copy_n(result.joints.data(), result.joints.size(), match.joints);
    softfinger::hand_out(match, out);
    return SF_DONE;
  });
}

sf_status sf_device_workspace(const sf_device* handle, char* text, size_t capacity, size_t* count) {
  return softfinger::with_device(handle, [&](const DeviceUse&, const Device& device) {
    softfinger::copy_text(softfinger::workspace_report(device.workspace_summary()).dump(2), text,
                          capacity, count);
    return SF_DONE;
  });
}
