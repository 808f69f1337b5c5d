#include "softfinger/motors/servo_table/servo_table_settings.hpp"

#include <fmt/core.h>

#include <array>

namespace softfinger {
namespace {

/// Turn of a servo on a bus in ticks.
constexpr double kTurn = 4096.0;

/// Below what servos endure (80 degrees for a Dynamixel XM430), above what they reach in good use.
constexpr int kMaxTemperature = 70;

constexpr std::array kLineKeys{
    KeyMeaning{"max_temperature_C",
               "a servo that says it is hotter has the device retract; 0: none is asked"},
};

constexpr std::array kTableKeys{
    KeyMeaning{"id", "of the servo on its bus"},
    KeyMeaning{"zero_ticks", "position in ticks, 4096 a turn, at joint angle 0"},
    KeyMeaning{"ticks_per_deg", "position = zero_ticks + ticks_per_deg * joint angle"},
    KeyMeaning{"ticks_per_mm", "position = zero_ticks + ticks_per_mm * joint length"},
    KeyMeaning{"min_ticks", "least position ever sent; dynamixel: the servo's own limit too"},
    KeyMeaning{"max_ticks", "largest position ever sent; dynamixel: the servo's own limit too"},
    KeyMeaning{"current_limit",
               "in the servo's own unit (2.69 mA for XM430, 1 mA for XL330); with it the servo "
               "holds its position with no more current than that; 0: as the servo is set"},
};

}  // namespace

ServoSettings read_table_servo(const ConfigTable& table, const std::string& slope, int last_id) {
  ServoSettings servo;
  servo.step = 1.0;
  servo.channel = table.integer("id", 0, last_id);
  servo.zero = table.number("zero_ticks", Range::between(-kTurn, 2.0 * kTurn));
  servo.per_radian = read_slope(table, slope);
  servo.min = table.integer("min_ticks", 0, 4095);
  servo.max = table.integer("max_ticks", 0, 4095);
  if (servo.min >= servo.max) table.fail("min_ticks", "must be less than max_ticks");
  return servo;
}

MotorKind servo_table_kind() {
  MotorKind kind;
  kind.wire = MotorKind::Wire::kSerial;
  kind.unit = "ticks";
  kind.whole_set_points = true;
  kind.has_torque = true;
  kind.servo_key = "id";
  kind.line_keys = kLineKeys;
  kind.read_line = [](const ConfigTable& table, TransportSettings& transport) {
    transport.max_temperature = table.integer("max_temperature_C", 0, 100, kMaxTemperature);
  };
  kind.line_text = [](const TransportSettings& transport) {
    return fmt::format("max_temperature_C = {}\n", transport.max_temperature);
  };
  kind.keys = kTableKeys;
  kind.servo_example = [](const std::string& slope, int joint) {
    return fmt::format("id = {}\nzero_ticks = 2048.0\n{} = 0.1\nmin_ticks = 0\nmax_ticks = 4095\n",
                       joint, slope);
  };
  kind.servo_name = [](const ServoSettings& servo) { return std::to_string(servo.channel); };
  kind.servo_name_text = [](const ServoSettings& servo) {
    return fmt::format("id = {}\n", servo.channel);
  };
  return kind;
}

}  // namespace softfinger
