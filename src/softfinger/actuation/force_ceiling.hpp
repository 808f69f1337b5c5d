#pragma once

#include <memory>
#include <stop_token>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// How much stiffer than the model a wearer is taken to be where a force limit counts.
inline constexpr double kStiffestWearer = 1.5;

[[nodiscard]] std::shared_ptr<const FingerModel> stiffest_wearer(const FingerModel& model);

/// Up to where a device may be advanced so that a wearer kStiffestWearer times as stiff as the
/// model is pressed with at most `max_force` (normal force, N, > 0): what a twin without friction
/// and relaxation feels, over a grid of the axes that do not advance the device. Nodes have
/// the least of what is found there, next to them and half-way, so that interpolation errs low.
/// Moves the device to poses that its limits exclude, where its linkage closes there. Uses all
/// cores. Throws InputError where nothing advances the device, or where it presses harder at home
/// or retracted, and when `stop` asks for an end.
[[nodiscard]] TravelCeiling force_ceiling(const FingerModel& model,
                                          const std::shared_ptr<const Device>& device,
                                          double max_force, const std::stop_token& stop = {});

}  // namespace softfinger
