#include "softfinger/session/device_fit.hpp"

#include <fmt/core.h>

#include <cstdint>
#include <memory>
#include <utility>

#include "softfinger/base/name_table.hpp"
#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/guard_beside_library.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/session/report/device_fit_report.hpp"
#include "softfinger/session/servo_calibration_file.hpp"

namespace softfinger {
namespace {

/// Of a table of names. Throws InputError where it has none of that.
template <typename Rows>
auto named(const char* key, const Rows& rows, const char* name) {
  if (const auto* row = row_named(rows, name)) return row->value;
  throw InputError(fmt::format("{} {}: there is {}", key, name, listed(names_of(rows), "or")));
}

DeviceFitOptions fit_options(const char* device, const char* finger, const char* person,
                             const sf_device_fit_options& given) {
  DeviceFitOptions options;
  options.device = file_or_shipped(Shipped::kDevice, device);
  options.finger = file_or_shipped(Shipped::kFinger, finger);
  options.person = person;
  if (given.name != nullptr) options.name = given.name;
  if (given.wearer != nullptr) options.wearer = file_or_shipped(Shipped::kFinger, given.wearer);
  if (given.sensor != nullptr) {
    options.sensor = named("sensor", kForceSensorKinds, given.sensor);
  }
  if (given.sensor_noise_given != 0) options.sensor_noise = given.sensor_noise_N;
  if (given.seed != 0) options.seed = given.seed;
  options.again = given.again != 0;
  options.by_touch = given.by_touch != 0;
  options.told = [touches = given.touches, heard = std::int32_t{0}]() mutable {
    const std::int32_t counted = touches != nullptr ? *touches : 0;
    return counted != std::exchange(heard, counted);
  };
  options.real_time = given.real_time != 0;
  options.guard_program =
      given.guard_program != nullptr ? given.guard_program : guard_beside_library();
  if (given.fault != nullptr) options.fault = named("fault", kForceSensorFaults, given.fault);
  options.fault_at = given.fault_at_s;
  return options;
}

ServoCalibrationOptions calibration_options(const char* device, const char* to,
                                            const sf_calibrate_options& given) {
  if (given.at == nullptr || given.moved == nullptr) {
    throw InputError("at and moved: must not be NULL");
  }
  if (given.count > ServoCalibrationOptions::kMost) {
    throw InputError(fmt::format("count {}: a device has at most {} servos", given.count,
                                 ServoCalibrationOptions::kMost));
  }
  ServoCalibrationOptions options{.device = file_or_shipped(Shipped::kDevice, device),
                                  .out = to,
                                  .port = text_or_empty(given.port)};
  options.at.assign(given.at, given.at + given.count);
  options.moved.assign(given.moved, given.moved + given.count);
  return options;
}

}  // namespace
}  // namespace softfinger

sf_status sf_device_fit(const char* device, const char* finger, const char* person,
                        const sf_device_fit_options* options, sf_table** out, char* error,
                        size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (device == nullptr || finger == nullptr || person == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "device, finger, person and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const sf_device_fit_options given =
        softfinger::taken(options, sizeof(sf_device_fit_options), "sf_device_fit_options");
    const softfinger::HostWatch host(given.stop, given.progress);
    const softfinger::DeviceFit found = softfinger::fit_device(
        softfinger::fit_options(device, finger, person, given), host.stop(), host.observer());
    if (!found.failure.empty()) {
      throw softfinger::OperationError(
          fmt::format("device fit: {}; nothing written", found.failure));
    }
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::device_fit_report(found).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}

sf_status sf_device_calibrate(const char* device, const char* to,
                              const sf_calibrate_options* options, char* note, size_t capacity,
                              char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (device == nullptr || to == nullptr || options == nullptr) {
    return text.tell(SF_BAD_INPUT, "device, to and options must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    const sf_calibrate_options given =
        softfinger::taken(options, sizeof(sf_calibrate_options), "sf_calibrate_options");
    const softfinger::HostWatch host(given.stop, nullptr);
    softfinger::copy_text(softfinger::calibrate_servos(
                              softfinger::calibration_options(device, to, given), host.stop()),
                          note, capacity, nullptr);
    return SF_DONE;
  });
}
