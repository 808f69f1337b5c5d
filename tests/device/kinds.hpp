#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {

/// The shipped device files of the kinds that are written in code, sorted.
inline std::vector<std::filesystem::path> device_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/devices")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline std::shared_ptr<const Device> shipped(const std::string& name) {
  return load_device(source_folder() + "/devices/" + name + ".toml");
}

/// A configuration around the axes' range, or around zero where an axis has no limits of its own;
/// in the workspace or not.
inline Configuration random_configuration(const Device& device, std::mt19937& random) {
  Configuration q(device.degrees_of_freedom());
  for (int k = 0; k < q.size(); ++k) {
    const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
    const double some = axis.angular ? 30.0 * deg : 10.0 * mm;
    std::uniform_real_distribution<double> range(std::isfinite(axis.min) ? axis.min : -some,
                                                 std::isfinite(axis.max) ? axis.max : some);
    q[k] = range(random);
  }
  return q;
}

/// One in the workspace. Of many axes without limits of their own hardly a draw is within all:
/// nearer home, then.
inline Configuration random_reachable(const Device& device, std::mt19937& random) {
  for (int tried = 0; tried < 1000; ++tried) {
    const double spread = std::exp2(-tried / 20);
    const Configuration q =
        device.home() + spread * (random_configuration(device, random) - device.home());
    if (device.reachable(q)) return q;
  }
  throw std::logic_error("random_reachable: nothing near home is reachable");
}

/// A point about where a finger pad meets the device.
inline Vector3 random_pad_point(std::mt19937& random) {
  std::uniform_real_distribution<double> across(-10.0, 10.0);
  std::uniform_real_distribution<double> up(-12.0, -3.0);
  return Vector3(across(random), across(random), up(random)) * mm;
}

/// Steps for central differences of q.
inline Eigen::VectorXd difference_steps(const Device& device) {
  Eigen::VectorXd steps(device.degrees_of_freedom());
  for (int k = 0; k < steps.size(); ++k) {
    steps[k] = 1e-8 / device.axes()[static_cast<std::size_t>(k)].metric;
  }
  return steps;
}

}  // namespace softfinger
