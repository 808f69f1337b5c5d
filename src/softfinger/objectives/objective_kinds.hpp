#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

struct ObjectiveKind {
  std::string_view name;   ///< in files, flags and output
  std::string_view words;  ///< what the device renders with it, for people
  /// `model`: the simulated finger.
  std::unique_ptr<Objective> (*make)(const std::shared_ptr<const FingerModel>& model,
                                     const std::shared_ptr<const Device>& device);
  /// What a device must have for it, for people, and whether one has; null: any device will do.
  std::string_view needs = {};
  bool (*fits)(const Device& device) = nullptr;
};

/// Every kind, in the order in which people read of them.
[[nodiscard]] std::span<const ObjectiveKind> objective_kinds();
/// The kind of that name, which may be one that it had before; null: none.
[[nodiscard]] const ObjectiveKind* objective_kind(std::string_view name);
/// The one that the device's file names.
[[nodiscard]] const ObjectiveKind& objective_kind(const Device& device);

/// What recordings call a kind: its place among objective_kinds(); NaN for one that is not there.
[[nodiscard]] double number_of(const ObjectiveKind& kind);
/// The kind of that number; null: none.
[[nodiscard]] const ObjectiveKind* objective_numbered(double number);

/// Why the device cannot have this kind, and which it can, for people; empty: it can.
[[nodiscard]] std::string why_not(const ObjectiveKind& kind, const Device& device);

}  // namespace softfinger
