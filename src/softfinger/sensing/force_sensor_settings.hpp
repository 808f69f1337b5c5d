#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "softfinger/base/name_table.hpp"

namespace softfinger {

class ConfigTable;

enum class ForceSensorKind : std::uint8_t { kEmulator, kUdp, kOsc, kSerial };

struct ForceSensorKindRow {
  ForceSensorKind value;
  std::string_view name;
  std::string_view words;
};
inline constexpr std::array<ForceSensorKindRow, 4> kForceSensorKinds{{
    {ForceSensorKind::kEmulator, "emulator", "feels what a finger in the emulated device would"},
    {ForceSensorKind::kUdp, "udp", "datagrams, a number as text each"},
    {ForceSensorKind::kOsc, "osc", "Open Sound Control, /force with one number"},
    {ForceSensorKind::kSerial, "serial", "a board that prints a number a line"},
}};

/// `[force_sensor]` of a device file: what tells the force on the wearer's finger.
struct ForceSensorSettings {
  static constexpr std::string_view kEmulated = "emulator";  ///< as a port
  static constexpr double kLargestForce = 100.0;  ///< N; what says more is no sensor of a finger

  ForceSensorKind kind = ForceSensorKind::kEmulator;
  /// "emulator": whatever the kind, its far end is emulated, on a real wire. Else PORT or
  /// ADDRESS:PORT to listen at, or a serial port.
  std::string port{kEmulated};
  unsigned baud = 115200;  ///< of a serial port
  double rate = 80.0;      ///< readings a second
  double scale = 1.0;      ///< N a unit of what it says; what an emulator says is N
  double zero = 0.0;       ///< what it says without load, in its own unit
  double stale = 0.1;      ///< s; a reading older than that is none
  double noise = 0.0;      ///< of an emulated sensor, standard deviation, N
  /// Of an emulated sensor: how much more it says of a force that falls than of one that grows, a
  /// part of that.
  double hysteresis = 0.0;
  bool refine = false;  ///< a device that slips while it is worn is followed, see TravelOffset

  [[nodiscard]] double force(double reading) const { return scale * (reading - zero); }
  [[nodiscard]] bool is_emulated() const { return port == kEmulated; }
};

/// Throws InputError with file, line and key.
[[nodiscard]] ForceSensorSettings read_force_sensor(const ConfigTable& table);

}  // namespace softfinger
