// `[transport]` of a device file, kind by kind: what is read, what is refused, and where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "../support/folders.hpp"
#include "kinds.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/motors/transport_file.hpp"
#include "softfinger/motors/transport_text.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The thimble that is shipped with these motors.
std::string thimble_with(const std::string& motors) {
  return motors == "maestro" ? "thimble-3rrs" : "thimble-3rrs-" + motors;
}

std::string thimble_text(const std::string& motors) {
  std::ifstream input(source_folder() + "/devices/" + thimble_with(motors) + ".toml");
  return {std::istreambuf_iterator<char>(input), {}};
}

/// Empty where the shipped file, with one text replaced by another, is read.
std::string transport_refusal(const std::string& motors, const std::string& from,
                              const std::string& to) {
  std::string text = thimble_text(motors);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  const auto file = std::filesystem::path(testing::TempDir()) /
                    ("transport_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << text;
  try {
    static_cast<void>(load_device(file));
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("transport_"), testing::Not(HasSubstr("\n"))));
    return error.what();
  }
  return {};
}

TEST(TransportFile, ShippedThimblesDifferByTheirMotorsAlone) {
  using nlohmann::json;
  json maestro = json::parse(shipped("thimble-3rrs")->settings().as_read);
  for (const std::string& kind : transport_kinds()) {
    if (kind == "maestro") continue;
    const auto device = shipped("thimble-3rrs-" + kind);
    json other = json::parse(device->settings().as_read);
    EXPECT_EQ(other.at("transport").at("kind"), kind);
    for (const char* of_motors : {"transport", "statics"}) {
      other.erase(of_motors);
      maestro.erase(of_motors);
    }
    EXPECT_EQ(other, maestro) << kind;
    EXPECT_EQ(transport_refusal(kind, "port = \"emulator\"", "port = \"here\""), "");
  }
}

TEST(TransportFile, ReadsTheMapOfEachKind) {
  const auto dynamixel = shipped("thimble-3rrs-dynamixel")->settings().transport.value();
  EXPECT_EQ(dynamixel.servos[2].channel, 3);
  EXPECT_EQ(dynamixel.unit, "ticks");
  EXPECT_NEAR(dynamixel.servos[0].per_radian * 2.0 * 180.0 * deg, 4096.0, 1e-3);
  EXPECT_EQ(dynamixel.servos[0].step, 1.0);
  const auto osc = shipped("thimble-3rrs-osc")->settings().transport.value();
  EXPECT_EQ(osc.servos[1].address, "/thimble/joint/2");
  EXPECT_NEAR(osc.servos[1].per_radian * deg, 1.0, 1e-12);
  EXPECT_NEAR(osc.servos[1].min, -30.0, 1e-9);  // of the joints, where not given
  EXPECT_NEAR(osc.servos[1].max, 75.0, 1e-9);
  const auto weart = shipped("thimble-3rrs-weart")->settings().transport.value();
  EXPECT_TRUE(weart.follows_travel);
  EXPECT_EQ(weart.servos[0].address, "RIGHT:INDEX");
  EXPECT_NEAR(weart.servos[0].zero + weart.servos[0].per_radian * 7.0 * mm, 1.0, 1e-12);
}

TEST(TransportFile, RefusesWhatDoesNotFit) {
  const auto refusal = [](const char* motors, const char* from, const char* to) {
    return transport_refusal(motors, from, to);
  };
  for (const char* motors : {"dynamixel", "feetech"}) {
    EXPECT_THAT(refusal(motors, "id = 2", "id = 1"), AllOf(HasSubstr("id"), HasSubstr("servo 1")));
    EXPECT_THAT(refusal(motors, "id = 2", "id = 254"), HasSubstr("id"));
    EXPECT_THAT(refusal(motors, "id = 2", "channel = 2"), HasSubstr("id"));
    EXPECT_THAT(refusal(motors, "max_ticks = 2656", "max_ticks = 2600"),
                AllOf(HasSubstr("ticks_per_deg"), HasSubstr("joint 1"), HasSubstr("2600")));
    EXPECT_THAT(refusal(motors, "max_ticks = 2656", "max_ticks = 4096"), HasSubstr("max_ticks"));
    EXPECT_THAT(refusal(motors, "zero_ticks = 1792.0", "zero_ticks = nan"),
                HasSubstr("zero_ticks"));
    EXPECT_THAT(refusal(motors, "min_ticks = 1440", "min_ticks = 2700"), HasSubstr("min_ticks"));
  }
  EXPECT_THAT(refusal("feetech", "id = 2", "id = 2\ncurrent_limit = 100"),
              HasSubstr("current_limit"));
  EXPECT_EQ(refusal("dynamixel", "id = 2", "id = 2\ncurrent_limit = 100"), "");
  EXPECT_THAT(refusal("osc", "/thimble/joint/2", "/thimble/joint/1"), HasSubstr("address"));
  EXPECT_THAT(refusal("osc", "/thimble/joint/2", "joint 2"), HasSubstr("OSC address"));
  EXPECT_THAT(refusal("osc", "rate_Hz = 30.0", "baud = 9600"), HasSubstr("baud"));
  EXPECT_THAT(refusal("osc", "address = \"/thimble/joint/2\"", "address = \"/b\"\nper_deg = 1e9"),
              HasSubstr("per_deg"));
  EXPECT_THAT(refusal("weart", "point = \"index\"", "point = \"ring\""), HasSubstr("point"));
  EXPECT_THAT(refusal("weart", "per_mm = 0.25", "per_mm = -0.25"), HasSubstr("per_mm"));
  EXPECT_THAT(refusal("weart", "max = 1.0", "max = 1.5"), HasSubstr("max"));
  EXPECT_THAT(refusal("weart", "max = 1.0", "max = 1.0\n[[transport.servo]]\nhand = \"left\""),
              HasSubstr("2 servos"));
  EXPECT_THAT(refusal("weart", "kind = \"weart\"", "kind = \"weert\""), HasSubstr("weart"));
}

TEST(TransportFile, TextIsReadBackAsItWas) {
  for (const std::string& motors : transport_kinds()) {
    const std::string text = thimble_text(motors);
    const auto device = shipped(thimble_with(motors));
    const auto file = std::filesystem::path(testing::TempDir()) /
                      ("transport_text_" + std::to_string(getpid()) + ".toml");
    std::ofstream(file) << text.substr(0, text.find("[transport]"))
                        << transport_text(device->settings().transport.value(), false);
    const auto again = load_device(file);
    const TransportSettings& a = device->settings().transport.value();
    const TransportSettings& b = again->settings().transport.value();
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.rate, b.rate);
    ASSERT_EQ(a.servos.size(), b.servos.size());
    for (std::size_t i = 0; i < a.servos.size(); ++i) {
      EXPECT_EQ(a.servos[i].channel, b.servos[i].channel);
      EXPECT_EQ(a.servos[i].address, b.servos[i].address);
      EXPECT_NEAR(a.servos[i].zero / a.unit_scale, b.servos[i].zero / a.unit_scale, 1e-5);
      EXPECT_NEAR(a.servos[i].per_radian / b.servos[i].per_radian, 1.0, 1e-8);
      EXPECT_NEAR(a.servos[i].min / a.unit_scale, b.servos[i].min / a.unit_scale, 1e-6);
      EXPECT_NEAR(a.servos[i].max / a.unit_scale, b.servos[i].max / a.unit_scale, 1e-6);
    }
  }
}

TEST(TransportFile, SchemaSaysWhatEveryKeyMeans) {
  using nlohmann::json;
  const json schema = json::parse(device_schema("platform_3rrs"));
  const json& kinds = schema.at("properties").at("transport").at("anyOf");
  ASSERT_EQ(kinds.size(), transport_kinds().size());
  for (const json& kind : kinds) {
    for (const auto& [key, rule] : kind.at("properties").items()) {
      EXPECT_TRUE(key == "kind" || rule.contains("description")) << key;
    }
    const json& servo = kind.at("properties").at("servo").at("items");
    for (const auto& [key, rule] : servo.at("properties").items()) {
      EXPECT_TRUE(rule.contains("description")) << kind.at("properties").at("kind") << key;
    }
  }
}

}  // namespace
}  // namespace softfinger
