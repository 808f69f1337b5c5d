#pragma once

#include <string>
#include <vector>

namespace softfinger {

inline constexpr int kMostServos = 24;  ///< of one device; channels of the largest Maestro

/// Map from one joint angle to one servo: set point = zero + per_radian * angle, cut to [min, max],
/// in the unit of the transport: the pulse width (s) for a Maestro, ticks for servos on a bus, any
/// number for OSC, force from 0 to 1 for WEART.
struct ServoSettings {
  int channel = 0;          ///< of a Maestro; id of a servo on a bus
  double zero = 1500e-6;    ///< set point at joint angle 0
  double per_radian = 0.0;  ///< a rad (a m where joints are lengths), not zero; negative where the
                            ///< servo is mounted reversed
  double min = 0.0;         ///< least set point ever sent
  double max = 0.0;         ///< largest set point ever sent
  double step = 0.25e-6;    ///< smallest difference the wire can say, > 0
  /// What the hardware is to keep to itself, set point a s and a s^2: somewhat more than the joint
  /// may do. 0: no limit is known.
  double max_rate = 0.0, max_acceleration = 0.0;
  int current_limit = 0;     ///< dynamixel: in the servo's own unit; 0: not given
  std::string address = {};  ///< osc: of its message; weart: "RIGHT:INDEX"
};

/// `[transport]` of a device file: how commands reach the motors.
struct TransportSettings {
  std::string kind;  ///< name of a MotorKind: "maestro", "dynamixel", ...
  std::string port;  ///< "emulator", a serial port, or host:port
  int baud = 115200;
  double rate = 30.0;                 ///< device ticks per second, Hz
  std::vector<ServoSettings> servos;  ///< one a joint, in joint order
  /// At the end, once the device is retracted, the servos let go instead of holding it there.
  bool limp_at_end = false;
  /// No servo may be hotter, degrees Celsius, as it says itself; 0: none is asked.
  int max_temperature = 0;
  bool crc = false;             ///< maestro: every command ends in a checksum
  double serial_timeout = 0.0;  ///< maestro: the board's own, s; 0: it is not relied on
  std::string unit = "us";      ///< of set points as people read them: "us", "ticks", ""
  double unit_scale = 1e-6;     ///< set point of one such unit
  /// The one servo follows the coordinate that leads the surface to the finger
  /// (Device::approach_axis()) and not a joint.
  bool follows_travel = false;
};

}  // namespace softfinger
