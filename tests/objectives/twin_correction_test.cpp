// What the wearer feels of objective "surface_and_force" where the device does not go where it was
// wanted, and where the surface match jumps.
#include "softfinger/objectives/twin_correction.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "pressed_finger.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

/// q moved along its first and its last component.
Configuration moved(Configuration q, double first, double last) {
  q[0] += first;
  q[q.size() - 1] += last;
  return q;
}

/// Renders `ticks` of the held finger; `surface` is the surface match of each, `went` where the
/// device goes then. Returns the wearer's part of the virtual force in each.
std::vector<double> felt(const PressedFinger& held, const std::shared_ptr<const Device>& device,
                         int ticks, const std::function<Configuration(int)>& surface,
                         const std::function<Configuration(int, const Configuration&)>& went) {
  TwinCorrection force(held.model, device);
  Twin wearer(held.model, device);
  std::vector<double> parts;
  for (int tick = 0; tick < ticks; ++tick) {
    RenderedSurface rendered;
    rendered.state = RenderingState::kTouching;
    rendered.configuration = surface(tick);
    const Configuration q = went(tick, force.tick(held.contact, {}, rendered, kTick).configuration);
    force.follow(q);
    wearer.press(q, held.contact.friction_coefficient, kTick);
    parts.push_back(wearer.contact().normal_force / held.contact.normal_force);
  }
  return parts;
}

/// Where a level device, moved from home alone, first bears half of that force.
Configuration near(const PressedFinger& held, const std::shared_ptr<const Device>& device) {
  Configuration q = device->home();
  Twin twin(held.model, device);
  while (twin.contact().normal_force < 0.5 * held.contact.normal_force) {
    device->advance(0.1 * mm, q);
    twin.press(q, 0.0, 0.0);
  }
  return q;
}

TEST(TwinCorrection, TheTwinGoesTheWayOfTheDevice) {
  const PressedFinger held(1.0 * mm);
  ASSERT_GT(held.contact.normal_force, 0.3);
  const auto device = device_of("delta-schorr");
  const Configuration start = near(held, device);
  const auto parts = felt(
      held, device, 24, [&](int) { return start; },
      [&](int tick, const Configuration& wanted) {
        // For a while something holds the device aside; skin is dragged along.
        const bool aside = tick >= 8 && tick < 14;
        return aside ? moved(wanted, 2.5 * mm, 0.0) : wanted;
      });
  for (std::size_t tick = 5; tick < 8; ++tick) EXPECT_NEAR(parts[tick], 1.0, 0.03) << tick;
  for (std::size_t tick = 18; tick < 24; ++tick) EXPECT_NEAR(parts[tick], 1.0, 0.03) << tick;
}

TEST(TwinCorrection, ASurfaceThatJumpsTakesNobodyAlong) {
  const PressedFinger held(1.0 * mm);
  const auto device = device_of("delta-schorr");
  const Configuration start = near(held, device);
  const auto parts = felt(
      held, device, 20,
      [&](int tick) {
        return tick >= 10 && tick % 3 == 1 ? moved(start, 3.0 * mm, -2.0 * mm) : start;
      },
      [](int, const Configuration& wanted) { return wanted; });
  for (std::size_t tick = 5; tick < 20; ++tick) EXPECT_NEAR(parts[tick], 1.0, 0.03) << tick;
}

}  // namespace
}  // namespace softfinger
