#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

inline std::shared_ptr<const Device> thimble() {
  static const std::shared_ptr<const Device> device =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  return device;
}

inline Configuration configuration(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

/// A patch of skin samples like a finger pad's, pressed by a plane or a ball: samples inside the
/// object are put on its surface and counted in contact.
struct Pad {
  std::vector<Vector3> points;
  std::vector<std::uint8_t> in_contact;
  std::vector<double> areas, gaps;

  [[nodiscard]] ContactPoints view() const { return {points, in_contact, areas, gaps}; }
  [[nodiscard]] int size() const { return static_cast<int>(points.size()); }
  [[nodiscard]] int contacts() const {
    int count = 0;
    for (const std::uint8_t c : in_contact) count += c;
    return count;
  }
};

/// The pad at rest: `count` samples of the lower half of an ellipsoid, no two alike.
inline Pad resting_pad(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Pad pad;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.39996323 * i + 0.3 * unit(random);
    const double down = 1.0 - 0.95 * (i + unit(random)) / count;
    const double across = std::sqrt(1.0 - down * down);
    pad.points.emplace_back(12.5 * mm * across * std::cos(azimuth),
                            8.0 * mm * across * std::sin(azimuth), -7.3 * mm * down);
    pad.areas.push_back((2.0 + unit(random)) * mm2);
  }
  pad.in_contact.assign(pad.points.size(), 0);
  pad.gaps.assign(pad.points.size(), 0.0);
  return pad;
}

/// Presses against a plane through `point` with unit normal `normal` (out of the object).
inline Pad press_plane(Pad pad, const Vector3& point, const Vector3& normal) {
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    const double gap = normal.dot(pad.points[i] - point);
    pad.in_contact[i] = gap <= 0.0;
    pad.gaps[i] = std::max(0.0, gap);
    if (gap < 0.0) pad.points[i] -= gap * normal;
  }
  return pad;
}

inline Pad press_ball(Pad pad, const Vector3& centre, double radius) {
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    const Vector3 out = pad.points[i] - centre;
    const double gap = out.norm() - radius;
    pad.in_contact[i] = gap <= 0.0;
    pad.gaps[i] = std::max(0.0, gap);
    if (gap < 0.0) pad.points[i] = centre + out.normalized() * radius;
  }
  return pad;
}

/// A pad pressed by something drawn at random, up to `tilt_deg` off.
inline Pad random_press(std::mt19937& random, double tilt_deg, int count = 120) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double azimuth = 2.0 * std::numbers::pi * unit(random);
  const double tilt = tilt_deg * deg * std::sqrt(unit(random));
  const Vector3 normal(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                       std::cos(tilt));
  const double depth = 3.0 * mm * unit(random);
  const Pad rest = resting_pad(count, random);
  // Deepest sample along the normal is the first to touch.
  double lowest = 1.0;
  for (const Vector3& p : rest.points) lowest = std::min(lowest, normal.dot(p));
  if (unit(random) < 0.5) return press_plane(rest, (lowest + depth) * normal, normal);
  const double radius = (5.0 + 20.0 * unit(random)) * mm;
  Vector3 touch = Vector3::Zero();
  for (const Vector3& p : rest.points) {
    if (normal.dot(p) <= lowest) touch = p;
  }
  return press_ball(rest, touch + (depth - radius) * normal, radius);
}

}  // namespace softfinger
