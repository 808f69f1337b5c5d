#pragma once

#include <string>
#include <vector>

namespace softfinger {

inline constexpr int kMostServos = 24;  ///< of one device; channels of the largest Maestro

/// Map from one joint angle to one servo: set point = zero + per_radian * angle, cut to [min, max],
/// in the unit of the transport: for a Maestro the pulse width, s.
struct ServoSettings {
  int channel = 0;
  double zero = 1500e-6;    ///< set point at joint angle 0
  double per_radian = 0.0;  ///< a rad (a m where joints are lengths), not zero; negative where the
                            ///< servo is mounted reversed
  double min = 0.0;         ///< least set point ever sent
  double max = 0.0;         ///< largest set point ever sent
  double step = 0.25e-6;    ///< smallest difference the wire can say, > 0
};

/// `[transport]` of a device file: how commands reach the motors.
struct TransportSettings {
  std::string kind;  ///< "maestro"
  std::string port;  ///< "emulator" or a serial port
  int baud = 115200;
  double rate = 30.0;                 ///< device ticks per second, Hz
  std::vector<ServoSettings> servos;  ///< one a joint, in joint order
};

}  // namespace softfinger
