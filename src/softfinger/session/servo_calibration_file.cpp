#include "softfinger/session/servo_calibration_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/servo_calibration.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/transport_file.hpp"
#include "softfinger/motors/transport_text.hpp"

namespace softfinger {
namespace {

void check_answers(const ServoCalibrationOptions& options, int servos) {
  const auto count = static_cast<std::size_t>(servos);
  if (options.at.empty() && options.moved.empty()) {
    if (options.ask_at && options.ask_moved) return;
    throw InputError("--at and --moved: must say what was seen of each joint");
  }
  if (options.at.size() != count || options.moved.size() != count) {
    throw InputError(fmt::format("--at and --moved: need {} numbers each, one a servo", servos));
  }
  const auto finite = [](const std::vector<double>& numbers) {
    return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
  };
  if (!finite(options.at) || !finite(options.moved)) {
    throw InputError("--at and --moved: must be finite numbers");
  }
}

/// What the section would be refused for when it is read again.
void check_cover(const ServoCalibrationOptions& options, const TransportSettings& found,
                 const JointLimits& limits) {
  const double unit = limits.linear ? mm : deg;
  double least = limits.min.maxCoeff();
  double largest = limits.max.minCoeff();
  double missing = 0.0;  // set points, in the unit of the file
  int worst = 0;
  for (std::size_t i = 0; i < found.servos.size(); ++i) {
    const ServoSettings& servo = found.servos[i];
    const auto joint = static_cast<Eigen::Index>(i);
    const JointRange range = joint_range(servo);
    least = std::max(least, range.min);
    largest = std::min(largest, range.max);
    const double beyond = std::max(range.min - limits.min[joint], limits.max[joint] - range.max) *
                          std::abs(servo.per_radian) / found.unit_scale;
    if (beyond > missing) {
      missing = beyond;
      worst = static_cast<int>(i) + 1;
    }
  }
  constexpr double kRounding = 1e-4;
  if (missing > kRounding) {
    const std::string narrower = least < largest
                                     ? fmt::format("narrow the joints' limits to [{:.1f}, {:.1f}]",
                                                   std::ceil(least / unit * 10.0) / 10.0,
                                                   std::floor(largest / unit * 10.0) / 10.0)
                                     : std::string("look again where it stands");
    throw InputError(fmt::format(
        "{}: not written: joint {} does not reach its limits with the set points allowed; widen "
        "them by {:.0f} {}, put its horn on anew, or {}, in {}",
        options.out.string(), worst, std::ceil(missing),
        found.unit.empty() ? "(its unit)" : found.unit, narrower, options.device.string()));
  }
  try {
    const ConfigFile again(options.out, transport_text(found, limits.linear));
    (void)read_transport(again.root().table("transport"), limits);
  } catch (const InputError& error) {
    throw InputError(fmt::format("not written, a device could not have it: {}", error.what()));
  }
}

void write(const ServoCalibrationOptions& options, const std::string& remarks,
           const TransportSettings& found, bool linear) {
  std::ofstream file(options.out);
  file << "# Servos as calibrated; take this in place of [transport] in " << options.device.string()
       << ".\n"
       << remarks << transport_text(found, linear);
  file.close();
  if (file) return;
  std::error_code ignored;
  std::filesystem::remove(options.out, ignored);
  throw OperationError(
      fmt::format("{}: cannot be written (is there room on the disk?)", options.out.string()));
}

}  // namespace

std::string calibrate_servos(const ServoCalibrationOptions& options,
                             const std::atomic<bool>& stop) {
  if (std::filesystem::exists(options.out)) {
    throw InputError(fmt::format("{} exists; name a new file", options.out.string()));
  }
  const auto device = load_device(options.device);
  ServoCalibration calibration(device, options.port, stop);
  check_answers(options, calibration.servos());
  const JointLimits& limits = device->joint_limits();
  const double unit = limits.linear ? mm : deg;
  const char* const unit_name = limits.linear ? "mm" : "degrees";

  TransportSettings result = device->settings().transport.value();
  std::string remarks;
  for (int i = 0; i < calibration.servos(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    ServoSighting seen;
    seen.at =
        unit * (options.at.empty() ? options.ask_at(i + 1, calibration.home(i) / unit, unit_name)
                                   : options.at[at]);
    seen.told = calibration.move_away(i);
    seen.moved =
        unit * (options.moved.empty() ? options.ask_moved(i + 1, seen.told / unit, unit_name)
                                      : options.moved[at]);
    calibration.move_back();
    try {
      result.servos[at] = calibration.calibrated_servo(i, seen);
    } catch (const InputError& error) {
      throw InputError(fmt::format("joint {}: {}", i + 1, error.what()));
    }
    const JointRange range = joint_range(result.servos[at]);
    remarks += fmt::format("# joint {} reaches {:.1f} to {:.1f} {}\n", i + 1, range.min / unit,
                           range.max / unit, unit_name);
  }
  check_cover(options, result, limits);
  write(options, remarks, result, limits.linear);
  return remarks;
}

}  // namespace softfinger
