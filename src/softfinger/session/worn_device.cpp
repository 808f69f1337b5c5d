#include "softfinger/session/worn_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/finger/bone.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/session/kept_ceiling.hpp"
#include "softfinger/twin/resting_gap.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kShiftStep = 0.01 * mm;  // of a mount
constexpr double kMostShift = 5.0 * mm;   // a strap's worth
constexpr double kFarthest = 40.0 * mm;   // of surface motion from home that is looked at
constexpr double kAdvance = 0.5 * mm;     // that must bring the surface nearer
constexpr double kLeastApproach = 0.2;    // of that advance
constexpr double kSlack = 0.5 * mm;       // of the home gap, that an approach may be above it
constexpr double kTouching = -1e-6;       // m; a gap below this presses
constexpr int kSteps = 80;                // of an advance from home
constexpr int kDraws = 3000;              // of configurations, where no advance from home touches

/// How far the mount must go out, against its z, for a least gap of `clearance` where the
/// configuration is zero, m.
double shift_for(const Device& device, std::span<const Vector3> skin, double clearance) {
  RestingGap gap(device, skin);
  Configuration neutral = Configuration::Zero(device.degrees_of_freedom());
  if (!device.reachable(neutral)) neutral = device.home();
  const Vector3 towards_F = device.settings().X_FB.rotation.col(2);
  const auto lack = [&](double shift) { return clearance - gap.at(neutral, shift, towards_F); };
  // The gap changes by no more than the shift, so that steps of the lack never go too far out.
  double shift = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double step = lack(shift);
    shift += step;
    if (std::abs(step) < 0.01 * kShiftStep) break;
  }
  return std::round(shift / kShiftStep) * kShiftStep;
}

/// The file as the device was read from it.
ConfigTable root_of(const fs::path& file, const Device& device) {
  return ConfigFile(file, device.settings().text).root();
}

[[noreturn]] void refuse(const fs::path& file, const Device& device, const char* table,
                         const char* key, const std::string& why) {
  const ConfigTable root = root_of(file, device);
  if (root.has(table)) root.table(table).fail(root.table(table).has(key) ? key : "", why);
  root.table_or_empty(table).fail(key, why);
}

/// Mounted, or its surface at home, inside the bone.
void check_bone(const fs::path& file, const Device& device, const FingerModel& finger) {
  const BoneEllipsoid bone = bone_ellipsoid(finger);
  const auto inside = [&](const char* table, const char* key, const char* what) {
    refuse(file, device, table, key,
           fmt::format("puts {} inside the bone of {}; the pad lies below it, towards -z", what,
                       finger.file.string()));
  };
  if (bone.contains(device.settings().X_FB.translation)) {
    inside("mount", "translation_mm", "the device");
  }
  bool within = bone.contains(device.surface_pose(device.home()).translation);
  std::vector<SolidPiece> pieces(static_cast<std::size_t>(device.solid_piece_count()));
  device.solid_pieces(device.home(), pieces);
  for (const SolidPiece& piece : pieces) {
    within = within || bone.contains(piece.X_FS.translation);
  }
  if (!within) return;
  if (root_of(file, device).has("home")) inside("home", "", "the contacting surface");
  inside("mount", "translation_mm", "the contacting surface at home");
}

/// Home and retracted keep off the resting skin.
void check_rest(const fs::path& file, const Device& device, const FingerModel& finger,
                RestingGap& gap) {
  const auto check = [&](const Configuration& q, const char* table, const char* where) {
    const double at = gap.at(q);
    if (at >= kTouching) return;
    const std::string why = fmt::format(
        "presses {:.2f} mm into the resting skin of {} {}; move it away from the "
        "finger, or the mount, or give [mount] clearance_mm",
        -at / mm, finger.file.string(), where);
    const bool moved = !q.isZero();
    refuse(file, device, moved ? table : "mount", moved ? "" : "translation_mm", why);
  };
  check(device.home(), "home", "at home");
  check(device.retracted(), "retract", "where it retracts to");
}

/// Least gap over the workspace, as far as it is looked at; ends where it touches.
double nearest_in_reach(const Device& device, RestingGap& gap) {
  double least = gap.at(device.home());
  const auto look = [&](const Configuration& q) {
    if (device.reachable(q)) least = std::min(least, gap.at(q));
  };
  for (int i = 1; device.advances() && i <= kSteps && least > kTouching; ++i) {
    Configuration q = device.home();
    device.advance(kFarthest * i / kSteps, q);
    for (int k = 0; k < q.size(); ++k) {
      q[k] = std::min(q[k], device.axes()[static_cast<std::size_t>(k)].max);
    }
    look(q);
  }
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same answer every time
  std::uniform_real_distribution<double> even(0.0, 1.0);
  for (int draw = 0; draw < kDraws && least > kTouching; ++draw) {
    Configuration q = device.home();
    for (int k = 0; k < q.size(); ++k) {
      const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
      const double far = kFarthest / axis.metric;
      const double min = std::max(axis.min, q[k] - far);
      const double max = std::min(axis.max, q[k] + far);
      q[k] = min + (max - min) * even(random);
    }
    look(q);
  }
  return least;
}

void check_reach(const fs::path& file, const Device& device, const FingerModel& finger,
                 RestingGap& gap) {
  const double least = nearest_in_reach(device, gap);
  if (least <= 0.0) return;
  refuse(file, device, "mount", "translation_mm",
         fmt::format("keeps the device from touching: wherever it goes it stays {:.2f} mm off the "
                     "resting skin of {}; mount it nearer, or widen [limits]",
                     least / mm, finger.file.string()));
}

/// What is called advance brings the surface nearer to the skin.
void check_advance(const fs::path& file, const Device& device, RestingGap& gap) {
  if (!device.advances()) return;
  Configuration nearer = device.home();
  Configuration further = device.home();
  device.advance(kAdvance, nearer);
  device.advance(-kAdvance, further);
  if (gap.at(further) - gap.at(nearer) >= 2.0 * kLeastApproach * kAdvance) return;
  const int axis = device.approach_axis();
  const std::string name = axis < 0 ? "" : device.axes()[static_cast<std::size_t>(axis)].name;
  refuse(file, device, "matching", "approach",
         fmt::format("{} does not bring the surface nearer to the finger where it grows; name a "
                     "coordinate that does, or turn its sign",
                     name));
}

void note_approach(const Device& device, RestingGap& gap, std::vector<DeviceNotice>& notices) {
  const double approach = device.settings().matching.approach;
  const double home = gap.at(device.home());
  if (!device.advances() || approach <= home + kSlack) return;
  notices.push_back(
      {"matching.approach_mm",
       fmt::format("{:.2f} is more than the {:.2f} mm between the device at home and the skin: it "
                   "draws back when an object comes near, and may not get as far as that",
                   approach / mm, home / mm)});
}

/// A measured force corrects how far the device is advanced.
void check_force_sensor(const fs::path& file, const Device& device) {
  if (!device.settings().force_sensor || device.advances()) return;
  refuse(file, device, "force_sensor", "kind",
         "corrects nothing, no coordinate of this device is known to move its surface towards the "
         "finger; name it by [matching] approach, or leave the table out");
}

void check_objective(const fs::path& file, const Device& device) {
  const std::string why = why_not(objective_kind(device), device);
  if (!why.empty()) refuse(file, device, "matching", "objective", why);
}

/// Looks whether it can be worn.
WornDevice checked_on(const FingerModel& finger, const fs::path& file,
                      std::shared_ptr<const Device> device) {
  const std::vector<Vector3> skin = rest_skin_points(finger);
  WornDevice worn{.device = std::move(device)};
  const Device& on = *worn.device;
  check_bone(file, on, finger);
  check_force_sensor(file, on);
  check_objective(file, on);
  RestingGap gap(on, skin);
  check_advance(file, on, gap);
  check_rest(file, on, finger, gap);
  check_reach(file, on, finger, gap);
  note_approach(on, gap, worn.notices);
  return worn;
}

}  // namespace

std::shared_ptr<const Device> mounted_on(const FingerModel& finger, const fs::path& file) {
  return mounted_on(finger, file, read_text_file(file, ConfigFile::kMaxSize));
}

std::shared_ptr<const Device> mounted_on(const FingerModel& finger, const fs::path& file,
                                         const std::string& text) {
  std::shared_ptr<const Device> device = load_device(file, text, 0.0);
  const auto clearance = device->settings().clearance;
  if (!clearance) return device;
  const double shift = shift_for(*device, rest_skin_points(finger), *clearance);
  if (std::abs(shift) > kMostShift) {
    refuse(file, *device, "mount", "clearance_mm",
           fmt::format("would shift the mount by {:.2f} mm to fit {}, more than {:g} mm; put "
                       "translation_mm where the device belongs on such a finger",
                       shift / mm, finger.file.string(), kMostShift / mm));
  }
  return shift == 0.0 ? device : load_device(file, text, shift);
}

std::shared_ptr<const TravelCeiling> ceiling_on(const FingerModel& finger, const fs::path& file,
                                                const std::shared_ptr<const Device>& device,
                                                const std::stop_token& stop) {
  if (!(device->settings().max_force > 0.0)) return nullptr;
  try {
    return std::make_shared<TravelCeiling>(
        kept_force_ceiling(finger, device, device->settings().max_force, stop));
  } catch (const InputError& error) {
    root_of(file, *device).table("limits").fail("max_force_N", error.what());
  }
}

WornDevice worn_on(const FingerModel& finger, const fs::path& file, const std::stop_token& stop) {
  WornDevice worn = worn_on(finger, file, read_text_file(file, ConfigFile::kMaxSize));
  worn.ceiling = ceiling_on(finger, file, worn.device, stop);
  return worn;
}

WornDevice worn_on(const FingerModel& finger, const fs::path& file, const std::string& text) {
  return checked_on(finger, file, mounted_on(finger, file, text));
}

WornDevice fitted_without_ceiling(const FingerModel& finger, const FingerModel& nominal,
                                  const fs::path& file, const Pose& mount_fit) {
  return checked_on(finger, file, mounted_on(nominal, file)->mounted(mount_fit));
}

WornDevice fitted_on(const FingerModel& finger, const FingerModel& nominal, const fs::path& file,
                     const Pose& mount_fit, const std::stop_token& stop) {
  WornDevice worn = fitted_without_ceiling(finger, nominal, file, mount_fit);
  worn.ceiling = ceiling_on(finger, file, worn.device, stop);
  return worn;
}

}  // namespace softfinger
