#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "../support/folders.hpp"
#include "kinds.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What is said about a shipped file with `from` replaced by `to`; empty where it is accepted.
std::string said_about(const std::string& name, const std::string& from, const std::string& to) {
  std::ifstream shipped_file(source_folder() + "/devices/" + name + ".toml");
  std::stringstream text;
  text << shipped_file.rdbuf();
  std::string content = text.str();
  const std::size_t at = content.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  content.replace(at, from.size(), to);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     ("kind_under_test_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << content;
  try {
    static_cast<void>(load_device(file));
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, HasSubstr("kind_under_test_"));
    return message;
  }
  return {};
}

TEST(DeviceKindFiles, UnknownKindListsTheKinds) {
  const std::string message =
      said_about("membrane", "kind = \"membrane\"", "kind = \"exoskeleton\"");
  EXPECT_THAT(message, HasSubstr("kind"));
  for (const std::string& kind : device_kind_names()) EXPECT_THAT(message, HasSubstr(kind));
}

TEST(DeviceKindFiles, PinArrays) {
  const std::string name = "pins-wagner-6x6";
  EXPECT_EQ(said_about(name, "rows = 6", "rows = 16"), "");
  EXPECT_THAT(said_about(name, "rows = 6", "rows = 0"), HasSubstr("rows"));
  EXPECT_THAT(said_about(name, "rows = 6", "rows = 17"), AllOf(HasSubstr("rows"), HasSubstr("16")));
  EXPECT_THAT(said_about(name, "rows = 6", "rows = 6.5"), HasSubstr("rows"));
  EXPECT_THAT(said_about(name, "pin_radius_mm = 0.5", "pin_radius_mm = 1.01"),
              AllOf(HasSubstr("pin_radius_mm"), HasSubstr("overlap")));
  EXPECT_THAT(said_about(name, "stroke_mm = 2.0", "stroke_mm = 0.0"), HasSubstr("stroke_mm"));
  EXPECT_EQ(said_about(name, "[limits]", "[home]\nheight_5_5_mm = 2.0\n[limits]"), "");
  EXPECT_THAT(said_about(name, "[limits]", "[home]\nheight_0_0_mm = 2.5\n[limits]"),
              AllOf(HasSubstr("home"), HasSubstr("height_0_0_mm"), HasSubstr("[0, 2]")));
  EXPECT_THAT(said_about(name, "[limits]", "[home]\nheight_6_0_mm = 1.0\n[limits]"),
              HasSubstr("height_6_0_mm"));
}

TEST(DeviceKindFiles, Membranes) {
  EXPECT_THAT(said_about("membrane", "height_mm = [0.0, 4.0]", "height_mm = [0.0, 7.5]"),
              AllOf(HasSubstr("height_mm"), HasSubstr("half a ball")));
  EXPECT_THAT(said_about("membrane", "height_mm = [0.0, 4.0]", "height_mm = [4.0, 0.0]"),
              AllOf(HasSubstr("height_mm"), HasSubstr("least")));
  EXPECT_THAT(said_about("membrane", "height_mm = [0.0, 4.0]", "height_mm = [1.0, 4.0]"),
              AllOf(HasSubstr("home"), HasSubstr("height_mm")));
}

TEST(DeviceKindFiles, Rollers) {
  EXPECT_THAT(said_about("roller-provancher", "height_mm = [-4.0, 7.0]", "height_mm = [1.0, 7.0]"),
              AllOf(HasSubstr("home"), HasSubstr("height_mm")));
  EXPECT_THAT(said_about("roller-provancher", "height_mm = -4.0", "height_mm = -5.0"),
              HasSubstr("retract"));
  EXPECT_THAT(
      said_about("roller-provancher", "roller_edge_radius_mm = 0.5", "roller_edge_radius_mm = 5.5"),
      HasSubstr("roller_edge_radius_mm"));
}

TEST(DeviceKindFiles, LinearDrives) {
  const std::string name = "disk-linear";
  EXPECT_EQ(said_about(name, "type = \"disk\"\nradius_mm = 6.0\nedge_radius_mm = 0.5",
                       "type = \"box\"\nsize_mm = [8.0, 6.0, 2.0]"),
            "");
  EXPECT_THAT(said_about(name, "[[surface]]",
                         "[[drive]]\nname = \"aside_mm\"\naxis = [0.0, 0.0, "
                         "2.0]\njoint_mm = [-1.0, 1.0]\n[[surface]]"),
              HasSubstr("not independent"));
  EXPECT_THAT(said_about(name, "[[surface]]",
                         "[[drive]]\nname = \"travel_mm\"\naxis = [1.0, 0.0, "
                         "0.0]\njoint_mm = [-1.0, 1.0]\n[[surface]]"),
              HasSubstr("travel_mm"));
  EXPECT_THAT(said_about(name, "name = \"travel_mm\"", "name = \"travel\""), HasSubstr("_mm"));
  EXPECT_THAT(said_about(name, "joint_mm = [-3.0, 7.0]", "joint_mm = [7.0, -3.0]"),
              AllOf(HasSubstr("joint_mm"), HasSubstr("least")));
  EXPECT_THAT(said_about(name, "joint_mm = [-3.0, 7.0]", "joint_mm = [-2.0, 7.0]"),
              HasSubstr("retract"));
  EXPECT_THAT(said_about(name, "axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.0, 0.0]"),
              HasSubstr("axis"));
}

TEST(DeviceKindFiles, DeltaTactors) {
  EXPECT_THAT(said_about("delta-schorr", "forearm_mm = 20.0", "forearm_mm = 2.0"),
              AllOf(HasSubstr("home"), HasSubstr("do not reach")));
  EXPECT_THAT(said_about("delta-schorr", "joint_deg = [-40.0, 100.0]", "joint_deg = [60.0, 100.0]"),
              AllOf(HasSubstr("home"), HasSubstr("joint 1")));
  EXPECT_THAT(said_about("delta-schorr", "max_us = 2210.0", "max_us = 2100.0"),
              HasSubstr("us_per_deg"));
}

TEST(DeviceKindFiles, Plates) {
  // Home says pitch_deg.
  EXPECT_THAT(said_about("plate-2dof", "turns = \"pitch\"", "turns = \"roll\""),
              HasSubstr("pitch_deg"));
  EXPECT_THAT(said_about("plate-2dof", "turns = \"pitch\"", "turns = \"yaw\""), HasSubstr("turns"));
  EXPECT_THAT(said_about("plate-2dof", "pitch_deg = 0.0", "pitch_deg = 31.0"),
              AllOf(HasSubstr("home"), HasSubstr("max_tilt_deg")));
  EXPECT_THAT(said_about("plate-2dof", "travel_mm = 0.0", "travel_mm = 11.0"),
              AllOf(HasSubstr("home"), HasSubstr("joint 1")));
}

TEST(DeviceKindFiles, CablesCannotPush) {
  const std::string name = "cable-prattichizzo";
  EXPECT_THAT(said_about(name, "spring_length_mm = 32.0", "spring_length_mm = 20.0"),
              AllOf(HasSubstr("home"), HasSubstr("would have to push")));
  EXPECT_THAT(said_about(name, "pitch_deg = 0.0", "pitch_deg = 31.0"), HasSubstr("max_tilt_deg"));
  EXPECT_THAT(said_about(name, "joint_deg = [-120.0, 150.0]", "joint_deg = [10.0, 150.0]"),
              AllOf(HasSubstr("home"), HasSubstr("joint 1")));
}

}  // namespace
}  // namespace softfinger
