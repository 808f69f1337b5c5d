#include "softfinger/wearer/press_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/twin/resting_gap.hpp"

namespace softfinger {
namespace {

constexpr double kTilt = 15.0 * deg;
constexpr double kCornerTilt = 20.0 * deg;
constexpr double kTurned = 3.0 * deg;    // of a tilt, that a device must come within
constexpr double kAlike = 1.0 * deg;     // of two tilts
constexpr double kFarthest = 20.0 * mm;  // from home, that is looked at
constexpr double kStep = 0.1 * mm;       // of looking

struct Tilt {
  double pitch, roll;
  bool corner;
};
/// Each near the one before.
constexpr std::array<Tilt, 9> kTilts{{{0.0, 0.0, false},
                                      {kTilt, 0.0, false},
                                      {kCornerTilt, kCornerTilt, true},
                                      {0.0, kTilt, false},
                                      {-kCornerTilt, kCornerTilt, true},
                                      {-kTilt, 0.0, false},
                                      {-kCornerTilt, -kCornerTilt, true},
                                      {0.0, -kTilt, false},
                                      {kCornerTilt, -kCornerTilt, true}}};

/// The surface's normal turned by a tilt: pitch towards +x, roll towards -y, of F.
Vector3 normal_of(const Tilt& tilt) {
  return exp_rotation({tilt.roll, tilt.pitch, 0.0}) * Vector3::UnitZ();
}

Vector3 surface_normal(const Device& device, const Configuration& q) {
  return device.surface_pose(q).rotation.col(2);
}

bool turns(const Device& device, const Tilt& tilt) {
  const Configuration q = device.facing(normal_of(tilt), device.home());
  const double turned = std::acos(
      std::clamp(surface_normal(device, q).dot(surface_normal(device, device.home())), -1.0, 1.0));
  return turned > kAlike;
}

double off(const Device& device, const Configuration& q, const Tilt& tilt) {
  return std::acos(std::clamp(surface_normal(device, q).dot(normal_of(tilt)), -1.0, 1.0));
}

std::string words(const Tilt& tilt) {
  return fmt::format("{:+.0f} degrees of pitch and {:+.0f} of roll", tilt.pitch / deg,
                     tilt.roll / deg);
}

}  // namespace

std::vector<PlannedPress> plan_presses(const Device& device, const FingerModel& finger,
                                       double depth) {
  if (!device.advances()) {
    throw InputError(
        "no coordinate of this device is known to move its surface towards the finger, so that it "
        "cannot press by itself; name one by [matching] approach");
  }
  const bool pitches = turns(device, {kTilt, 0.0, false});
  const bool rolls = turns(device, {0.0, kTilt, false});
  const std::vector<Vector3> skin = rest_skin_points(finger);
  RestingGap gap(device, skin);
  std::vector<PlannedPress> presses;
  for (const Tilt& tilt : kTilts) {
    if ((tilt.pitch != 0.0 && !pitches) || (tilt.roll != 0.0 && !rolls)) continue;
    PlannedPress press{.tilted = device.facing(normal_of(tilt), device.home()),
                       .pitch = tilt.pitch,
                       .roll = tilt.roll,
                       .spare = tilt.corner};
    const auto at = [&](double s) {
      Configuration q = press.tilted;
      device.advance(s, q);
      return q;
    };
    // A device at home may be so near that it touches when it is turned.
    double s = 0.0;
    while (gap.at(at(s)) < 0.0 && s > -kFarthest) s -= kStep;
    for (double left = gap.at(at(s)); left > 1e-6 && s < kFarthest; left = gap.at(at(s))) s += left;
    press.touch = s;
    while (press.most < kFarthest && device.reachable(at(press.most + kStep))) press.most += kStep;
    const bool turned = off(device, press.tilted, tilt) <= kTurned;
    if (!turned || !device.reachable(at(s)) || press.most < s + depth) {
      if (tilt.corner) continue;
      throw InputError(fmt::format(
          "its limits forbid a press with {}, {:.1f} mm beyond the resting skin, which is needed "
          "to tell what finger wears it; widen [limits]",
          words(tilt), depth / mm));
    }
    presses.push_back(press);
  }
  return presses;
}

}  // namespace softfinger
