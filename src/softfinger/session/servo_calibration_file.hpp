#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// How the servos of a device are calibrated. Angles and lengths here are in the unit of the
/// device's joints, degrees or mm.
struct ServoCalibrationOptions {
  static constexpr std::size_t kMost = kMostServos;  ///< of a device

  std::filesystem::path device;
  std::filesystem::path out;  ///< new file for the servos' section
  std::string port;           ///< instead of the device file's; empty: that
  /// What was seen of each joint: where it stands at home, and by how many it then moved; both
  /// empty: it is asked for.
  std::vector<double> at, moved;
  /// Someone who looks: where should stand at `expected`, where does it? By how many did it move
  /// that was told `told`? Not called where `at` and `moved` say it.
  std::function<double(int joint, double expected, const char* unit)> ask_at;
  std::function<double(int joint, double told, const char* unit)> ask_moved;
};

/// Moves each joint in turn, slowly, and writes what was seen as `[transport]` of a device file.
/// Returns a line a joint for people: what it reaches. Throws InputError for what is wrong,
/// OperationError where `stop` became true, the port is gone or the file cannot be written; however
/// it ends the device is led to where it is retracted, and what is not whole is not written.
[[nodiscard]] std::string calibrate_servos(const ServoCalibrationOptions& options,
                                           const std::atomic<bool>& stop);

}  // namespace softfinger
