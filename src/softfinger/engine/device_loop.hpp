#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "softfinger/actuation/actuator.hpp"
#include "softfinger/contact/contact_set.hpp"
#include "softfinger/engine/record.hpp"
#include "softfinger/matching/objective.hpp"
#include "softfinger/matching/surface_rendering.hpp"
#include "softfinger/twin/force_rendering.hpp"

namespace softfinger {

/// What a device tick is given.
struct TickInput {
  std::int64_t step = 0;
  double time = 0.0;                              ///< s, end of that step
  bool tracked = true;                            ///< the tracker knows where the finger is
  std::chrono::steady_clock::time_point arrival;  ///< of the pose the step used
  ContactSet contact;
};

/// The device side of one finger: contact set to motor command, tick by tick. The same code serves
/// headless and live runs, replays and the library.
class DeviceLoop {
 public:
  /// `model`: the simulated finger. `objective`: instead of the device file's. Throws
  /// InputError where the port cannot be opened.
  DeviceLoop(std::int64_t finger, const std::shared_ptr<const Device>& device,
             const std::shared_ptr<const FingerModel>& model, const ActuatorOptions& options,
             std::optional<Objective> objective = {});

  /// One device tick. Allocates nothing, takes no lock, throws nothing.
  const TickRecord& tick(std::int64_t step, double time, bool tracked, const ContactSet& contact,
                         std::chrono::steady_clock::time_point arrival);
  const TickRecord& tick(const TickInput& input) {
    return tick(input.step, input.time, input.tracked, input.contact, input.arrival);
  }
  /// The last tick; tick -1 before the first.
  [[nodiscard]] const TickRecord& record() const { return record_; }
  [[nodiscard]] const Device& device() const { return rendering_.device(); }
  [[nodiscard]] Actuator& actuator() { return actuator_; }
  [[nodiscard]] const Actuator& actuator() const { return actuator_; }

 private:
  Objective objective_;
  SurfaceRendering rendering_;
  std::unique_ptr<ForceRendering> force_;  ///< null: another objective
  Actuator actuator_;
  TickRecord record_;
};

}  // namespace softfinger
