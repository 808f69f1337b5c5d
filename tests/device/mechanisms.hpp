#pragma once

#include <memory>
#include <random>
#include <string>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/mechanism/mechanism.hpp"

namespace softfinger {

/// A shipped mechanism by the name of its file.
inline std::shared_ptr<const Device> mechanism(const std::string& name) {
  return load_device(source_folder() + "/devices/" + name + ".toml");
}
inline const Mechanism& linkage_of(const Device& device) {
  return dynamic_cast<const Mechanism&>(device.kinematics());
}

/// Draws configurations from a mechanism's workspace: up to `angle_deg` and `length_mm` from home.
class ReachableConfigurations {
 public:
  ReachableConfigurations(const Device& device, double angle_deg, double length_mm, unsigned seed)
      : device_(device), angle_(angle_deg * deg), length_(length_mm * mm), random_(seed) {}

  [[nodiscard]] Configuration draw() {
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    for (;;) {
      Configuration q = device_.home();
      for (int k = 0; k < q.size(); ++k) {
        q[k] += part(random_) *
                (device_.axes()[static_cast<std::size_t>(k)].angular ? angle_ : length_);
      }
      if (device_.reachable(q)) return q;
    }
  }
  [[nodiscard]] std::mt19937& random() { return random_; }

 private:
  const Device& device_;
  double angle_, length_;
  std::mt19937 random_;
};

/// Steps for central differences of q.
inline Eigen::VectorXd steps_of(const Device& device) {
  Eigen::VectorXd steps(device.degrees_of_freedom());
  for (int k = 0; k < steps.size(); ++k) {
    steps[k] = device.axes()[static_cast<std::size_t>(k)].angular ? 1e-5 : 1e-7;
  }
  return steps;
}

}  // namespace softfinger
