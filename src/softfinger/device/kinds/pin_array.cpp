#include "softfinger/device/kinds/pin_array.hpp"

#include <string>
#include <utility>

#include "softfinger/base/units.hpp"

namespace softfinger {

std::vector<ConfigurationAxis> PinDrives::axes_for(const PinArrayGeometry& geometry) {
  std::vector<ConfigurationAxis> axes;
  for (int i = 0; i < geometry.rows; ++i) {
    for (int j = 0; j < geometry.columns; ++j) {
      axes.push_back(ConfigurationAxis::length(
          "height_" + std::to_string(i) + "_" + std::to_string(j) + "_mm", 0.0, geometry.stroke));
    }
  }
  return axes;
}

void PinDrives::advance(double distance, Configuration& q) const { q.array() += distance; }

std::vector<AxisReach> PinDrives::reaches() const {
  return {{"height_mm", 0.0, axes()[0].max, mm}};
}

std::shared_ptr<const Device> make_pin_array(DeviceSettings settings,
                                             const PinArrayGeometry& geometry) {
  auto kinematics = std::make_unique<const PinDrives>(settings);
  auto surface = std::make_unique<const PinSurface>(geometry, settings.X_FB);
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::move(surface));
}

}  // namespace softfinger
