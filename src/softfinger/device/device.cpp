#include "softfinger/device/device.hpp"

#include <utility>

namespace softfinger {

std::shared_ptr<const Device> Device::mounted(const Pose& mount_fit) const {
  DeviceSettings settings = settings_;
  settings.fit_mount(mount_fit);
  auto kinematics = kinematics_->mounted(settings.X_FB);
  auto surface = surface_->mounted(settings.X_FB);
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::move(surface));
}

double Device::squared_distance(const Configuration& a, const Configuration& b) const {
  double sum = 0.0;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const double d = settings_.axes[static_cast<std::size_t>(k)].metric * (a[k] - b[k]);
    sum += d * d;
  }
  return sum;
}

}  // namespace softfinger
