#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/joint_limits.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// Steps of numbers sent as text or float, fine enough for any motor.
inline constexpr double kFineStep = 1e-6;

/// What a key of a device file means, in one line.
struct KeyMeaning {
  std::string_view key, text;
};

/// A kind of motors and of the wire to them: what `[transport]` of a device file says of them, and
/// what speaks to them. One folder beside this file, one row of motor_kinds().
struct MotorKind {
  enum class Wire { kSerial, kUdp, kTcp };

  std::string_view name;          ///< `transport.kind`
  Wire wire = Wire::kSerial;      ///< where not serial, the port is HOST:PORT
  int default_baud = 0;           ///< of a serial port
  std::string_view unit;          ///< of set points as people read them: "us", "ticks", ""
  double unit_scale = 1.0;        ///< set point of one such unit
  bool whole_set_points = false;  ///< in that unit
  bool follows_travel = false;    ///< see TransportSettings
  /// What becomes of the motors if this computer dies, in words; empty: they stop by themselves.
  std::string_view left_alone;
  /// Whether what the device file says takes care of that.
  bool (*is_watched)(const TransportSettings& transport) = nullptr;
  bool has_torque = false;                ///< that ServoBus::let_go() takes away
  std::string_view servo_key;             ///< by what servos are told apart
  std::span<const KeyMeaning> line_keys;  ///< that `[transport]` has for this kind alone
  std::span<const KeyMeaning> keys;       ///< of its `[[transport.servo]]`

  /// Reads those keys; null: there are none.
  void (*read_line)(const ConfigTable& table, TransportSettings& transport) = nullptr;
  /// The same as TOML, line by line.
  std::string (*line_text)(const TransportSettings& transport) = nullptr;
  /// Reads one `[[transport.servo]]`; `slope`: its key of set point per joint angle or length.
  ServoSettings (*read_servo)(const ConfigTable& table, const std::string& slope,
                              const JointLimits& limits, int joint);
  /// What it must say for the servo of a joint; TOML.
  std::string (*servo_example)(const std::string& slope, int joint);
  /// By what the servo is told apart, as people read it.
  std::string (*servo_name)(const ServoSettings& servo);
  /// The same as the keys of a `[[transport.servo]]`; TOML.
  std::string (*servo_name_text)(const ServoSettings& servo);

  /// `clock` outlives the bus. Throws InputError for settings that cannot be driven.
  std::unique_ptr<ServoBus> (*make_bus)(const TransportSettings& transport, LineClock& clock);
  std::unique_ptr<BusEmulator> (*make_emulator)(const TransportSettings& transport,
                                                std::span<const EmulatedServo> servos);
};

/// Key of a servo's set point per joint angle, or per length where joints are linear: "us_per_deg".
[[nodiscard]] std::string slope_key(const MotorKind& kind, bool linear_joints);
/// A key with the kind's unit: "zero_us".
[[nodiscard]] std::string key_with_unit(const MotorKind& kind, std::string_view key);

/// The slope at this key, which must not be 0.
[[nodiscard]] double read_slope(const ConfigTable& table, const std::string& key);

}  // namespace softfinger
