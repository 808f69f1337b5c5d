#pragma once

#include <string>
#include <vector>

namespace softfinger {

inline constexpr int kMostServos = 24;  ///< channels of the largest Maestro

/// Map from one joint angle to one servo: pulse = zero + per_radian * angle, cut to [min, max].
struct ServoSettings {
  int channel = 0;
  double zero = 1500e-6;    ///< pulse width at joint angle 0, s
  double per_radian = 0.0;  ///< s/rad (s/m where joints are lengths), not zero; negative where the
                            ///< servo is mounted reversed
  double min = 0.0;         ///< shortest pulse ever sent, s
  double max = 0.0;         ///< longest pulse ever sent, s
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
