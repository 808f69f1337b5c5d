#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// What people must know of a device on a finger: a limit or a setting that keeps it from touching,
/// or makes it touch.
struct DeviceNotice {
  std::string key;   ///< of the device file, "matching.approach_mm"
  std::string text;  ///< one line
};

/// A device as it sits on one finger.
struct WornDevice {
  std::shared_ptr<const Device> device;          ///< its mount shifted to fit; null: none is worn
  std::shared_ptr<const TravelCeiling> ceiling;  ///< null: its force has no limit
  std::vector<DeviceNotice> notices;
};

/// Reads a device file and puts the device on the finger: with `[mount] clearance_mm` shifted along
/// the mount's z, in hundredths of a millimetre and at most 5 mm, to have that least gap to the
/// resting skin where the configuration is zero. Throws InputError, with file, line and key, for
/// what load_device() refuses and for a shift that is larger.
[[nodiscard]] std::shared_ptr<const Device> mounted_on(const FingerModel& finger,
                                                       const std::filesystem::path& file);
/// The same of a file's text at hand, which may differ from the file.
[[nodiscard]] std::shared_ptr<const Device> mounted_on(const FingerModel& finger,
                                                       const std::filesystem::path& file,
                                                       const std::string& text);

/// The same, and looks whether it can be worn.
/// Throws InputError, with file, line and key, also for what force_ceiling() refuses and for a
/// device that could not be worn or would be of no use: mounted or at home inside the bone, resting
/// against the skin at home or retracted, too far from the skin to touch it from anywhere in its
/// workspace, or advancing away from it. And when `stop` asks for an end.
[[nodiscard]] WornDevice worn_on(const FingerModel& finger, const std::filesystem::path& file,
                                 const std::stop_token& stop = {});
/// The same of a text at hand, and without the ceiling, which takes far longer than all the rest.
[[nodiscard]] WornDevice worn_on(const FingerModel& finger, const std::filesystem::path& file,
                                 const std::string& text);
/// How far a device worn on this finger may be advanced; null: its file says nothing of force.
/// Throws as worn_on() does for force_ceiling().
[[nodiscard]] std::shared_ptr<const TravelCeiling> ceiling_on(
    const FingerModel& finger, const std::filesystem::path& file,
    const std::shared_ptr<const Device>& device, const std::stop_token& stop = {});

/// The same of a device that sits on this wearer otherwise than its file says, as was found on them
/// (DeviceSettings::mount_fit): `finger` with what was found of it, `nominal` as its file has it,
/// to which the mount is shifted.
[[nodiscard]] WornDevice fitted_on(const FingerModel& finger, const FingerModel& nominal,
                                   const std::filesystem::path& file, const Pose& mount_fit,
                                   const std::stop_token& stop = {});
/// The same without the ceiling, which takes far longer than all the rest.
[[nodiscard]] WornDevice fitted_without_ceiling(const FingerModel& finger,
                                                const FingerModel& nominal,
                                                const std::filesystem::path& file,
                                                const Pose& mount_fit);

}  // namespace softfinger
