#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/device/device.hpp"

/// Configuration by the names and in the units of the device's axes.
[[nodiscard]] nlohmann::ordered_json configuration_json(const softfinger::Device& device,
                                                        const softfinger::Configuration& q);
/// Joint angles in degrees.
[[nodiscard]] nlohmann::ordered_json joints_json(const softfinger::JointAngles& joints);
