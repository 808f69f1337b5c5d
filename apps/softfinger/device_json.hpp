#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/device/device.hpp"

/// Configuration by the names and in the units of the device's axes.
[[nodiscard]] nlohmann::ordered_json configuration_json(const softfinger::Device& device,
                                                        const softfinger::Configuration& q);
/// Adds `joints_deg` to an answer: null where `joints` is. Where joints are lengths, `joints_deg`
/// is null and `joints_mm` stands beside it.
void add_joints(nlohmann::ordered_json& answer, const softfinger::Device& device,
                const softfinger::JointAngles* joints);
