#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

struct ObjectiveKind {
  std::string_view name;   ///< in files, flags and output
  std::string_view words;  ///< what the device renders with it, for people
  /// A device file may name it, see kDeviceObjectives; the others are baselines that evaluations
  /// compare with.
  bool for_devices;
  /// `model`: the simulated finger.
  std::unique_ptr<Objective> (*make)(const std::shared_ptr<const FingerModel>& model,
                                     const std::shared_ptr<const Device>& device);
};

/// Every kind, in the order in which people read of them.
[[nodiscard]] std::span<const ObjectiveKind> objective_kinds();
/// The kind of that name; null: none.
[[nodiscard]] const ObjectiveKind* objective_kind(std::string_view name);
/// The one that the device's file names.
[[nodiscard]] const ObjectiveKind& objective_kind(const Device& device);

}  // namespace softfinger
