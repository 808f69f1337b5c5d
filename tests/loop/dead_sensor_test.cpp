// A force sensor that is dead must not make a run press harder.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/loop/travel_offset.hpp"

namespace softfinger {
namespace {

TEST(DeadForceSensor, CorrectsNextToNothing) {
  const std::filesystem::path project = source_folder();
  const auto device = load_device(project / "devices" / "thimble-3rrs.toml");
  for (const double says : {0.0, 0.4}) {
    TravelOffset offset(FingerModel::load(project / "fingers" / "index.toml"), device);
    ForceReading reading{says, device->home()};
    for (int tick = 0; tick < 60; ++tick) {
      reading.configuration = device->home();
      device->advance(3.0 * mm + tick * 0.02 * mm, reading.configuration);
      offset.update(reading, 0.5, 1.0 / 30.0);
    }
    EXPECT_LE(std::abs(offset.value()), 0.61 * mm) << says;
  }
  // One that lives does.
  TravelOffset offset(FingerModel::load(project / "fingers" / "index.toml"), device);
  ForceReading reading{0.0, device->home()};
  for (int tick = 0; tick < 60; ++tick) {
    reading.configuration = device->home();
    device->advance(4.0 * mm, reading.configuration);
    reading.normal_force = tick % 2 == 0 ? 0.001 : 0.002;
    offset.update(reading, 0.5, 1.0 / 30.0);
  }
  EXPECT_LT(offset.value(), -0.7 * mm);
}

}  // namespace
}  // namespace softfinger
