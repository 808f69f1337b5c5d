#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

class TravelCeilingGrid : public testing::Test {
 protected:
  TravelCeilingGrid() {
    for (std::size_t k = 0; k < 3 * 4; ++k) depths_.push_back((0.2 + uniform_(random_)) * mm);
  }
  [[nodiscard]] Configuration at(double pitch, double roll, double travel) const {
    Configuration q = device_->home();
    q << pitch, roll, travel;
    return q;
  }
  /// Along one axis after the other, constant beyond its ends.
  [[nodiscard]] double interpolated(double pitch, double roll) const {
    const auto along = [](const TravelCeiling::GridAxis& axis, double place, const auto& value) {
      const double step = (axis.max - axis.min) / (axis.count - 1);
      const double inside = std::clamp(place, axis.min, axis.max);
      for (int k = 0; k + 1 < axis.count; ++k) {
        const double from = axis.min + k * step;
        if (inside > from + step && k + 2 < axis.count) continue;
        return std::lerp(value(k), value(k + 1), (inside - from) / step);
      }
      return value(0);
    };
    return along(grid_[1], roll, [&](int row) {
      return along(grid_[0], pitch,
                   [&](int column) { return depths_[static_cast<std::size_t>(row * 3 + column)]; });
    });
  }

  std::shared_ptr<const Device> device_ =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  std::vector<TravelCeiling::GridAxis> grid_{{0, -0.3, 0.1, 3}, {1, -0.2, 0.4, 4}};
  std::mt19937_64 random_{37};
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::vector<double> depths_;  ///< pitch runs first
  std::vector<Vector3> point_{device_->surface_pose(device_->home()) * Vector3(0.0, 0.0, 2.0 * mm)};
};

// Anywhere between nodes, on them, and beyond.
TEST_F(TravelCeilingGrid, IsLinearAlongEachAxisBetweenNodes) {
  const TravelCeiling ceiling(device_, point_, grid_, depths_);
  std::vector<std::pair<double, double>> places;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column)
      places.emplace_back(-0.3 + 0.2 * column, -0.2 + 0.2 * row);
  }
  for (int k = 0; k < 200; ++k) {
    places.emplace_back(-0.4 + 0.6 * uniform_(random_), -0.3 + 0.8 * uniform_(random_));
  }
  for (const auto& [pitch, roll] : places) {
    const Configuration q = at(pitch, roll, 2.0 * mm);
    const double travel = ceiling.travel(q);
    ASSERT_NEAR(ceiling.depth(at(pitch, roll, travel)), interpolated(pitch, roll), 2e-7)
        << pitch << ' ' << roll;
    ASSERT_NEAR(ceiling.excess(q), 2.0 * mm - travel, 1e-12);
  }
}

TEST_F(TravelCeilingGrid, LowersToTheCeilingAndHardlyBelow) {
  const TravelCeiling ceiling(device_, point_, grid_, depths_);
  for (int k = 0; k < 200; ++k) {
    const double margin = 0.1 * mm * uniform_(random_);
    const Configuration before = at(-0.4 + 0.6 * uniform_(random_), -0.3 + 0.8 * uniform_(random_),
                                    6.0 * mm * uniform_(random_));
    Configuration q = before;
    ceiling.lower(q, margin);
    ASSERT_LE(ceiling.excess(q), -margin + 1e-12);
    if (q == before) continue;
    ASSERT_GE(ceiling.excess(q), -margin - 1.5e-7);
    ASSERT_EQ(q.head(2), before.head(2)) << "along travel alone";
  }
}

}  // namespace
}  // namespace softfinger
