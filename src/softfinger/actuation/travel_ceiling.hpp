#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// How far a device may be advanced towards the finger: so far beyond where, coming from home or
/// from where it is retracted, it first touches the resting skin as a table says over the axes that
/// do not advance it, linear in between and constant beyond. Counted by the advance, since what a
/// thin plate or a small tip reaches into the skin by does not grow for ever. Pins, which advance
/// one by one, have one ceiling for all instead. Does not allocate after construction.
class TravelCeiling {
 public:
  /// One axis of the table: component `axis` of q at `count` >= 2 equidistant values, SI.
  struct GridAxis {
    int axis;
    double min, max;
    int count;
  };
  static constexpr int kMostAxes = 6;

  /// `depths`: m, first grid axis fastest; for pins the one height. `rest_skin`: samples in F, m.
  TravelCeiling(std::shared_ptr<const Device> device, std::span<const Vector3> rest_skin,
                std::vector<GridAxis> grid, std::vector<double> depths);
  TravelCeiling(TravelCeiling&&) noexcept = default;
  TravelCeiling& operator=(TravelCeiling&&) noexcept = default;

  /// How far the device at q is advanced beyond its first touch of the resting skin, m; negative
  /// before. For pins the highest one's height.
  [[nodiscard]] double depth(const Configuration& q) const;
  /// How far q is above the ceiling, m; negative below.
  [[nodiscard]] double excess(const Configuration& q) const;
  /// q brought down, against the device's advance, to `margin` (m, >= 0) below the ceiling where
  /// it is higher.
  void lower(Configuration& q, double margin = 0.0) const;
  /// The ceiling of what advances, other axes as in q; SI.
  [[nodiscard]] double travel(const Configuration& q) const;

  // What it was made of.
  [[nodiscard]] std::vector<Vector3> rest_skin() const;
  [[nodiscard]] const std::vector<GridAxis>& grid() const { return grid_; }
  [[nodiscard]] const std::vector<double>& depths() const { return depths_; }

 private:
  [[nodiscard]] double limit(const Configuration& q) const;
  /// The advance of it, other axes as in q; SI.
  [[nodiscard]] double first_touch(const Configuration& q) const;

  std::shared_ptr<const Device> device_;
  std::vector<double> x_, y_, z_;
  SurfaceSamples skin_;
  std::vector<GridAxis> grid_;
  std::vector<double> depths_;
};

}  // namespace softfinger
