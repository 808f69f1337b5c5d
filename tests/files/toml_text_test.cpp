// Numbers of a TOML text are replaced where they stand; all else stays, lines included.
#include "softfinger/files/toml_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kTomlText = R"toml(# ünïcode in a comment
speed = 1_000.5           # root
kind = "none"
[mount]
translation_mm = [1.0, -2, 3e1]
[a.b]
deep = 4
inline = { x = 1.5, y = [2] }
[[object]]
name = "ball"
radius_mm = 20.0
[object.dynamics]
mass_g = 7
[[object]]
radius_mm = 5
)toml";

TomlText toml_text() { return {"device.toml", kTomlText}; }

TEST(TomlText, FindsNumbersByTheirWays) {
  const TomlText text = toml_text();
  EXPECT_EQ(text.number("speed"), 1000.5);
  EXPECT_EQ(text.number("mount.translation_mm.1"), -2.0);
  EXPECT_EQ(text.number("mount.translation_mm.2"), 30.0);
  EXPECT_EQ(text.number("a.b.deep"), 4.0);
  EXPECT_EQ(text.number("a.b.inline.x"), 1.5);
  EXPECT_EQ(text.number("a.b.inline.y.0"), 2.0);
  EXPECT_EQ(text.number("object.ball.radius_mm"), 20.0);
  EXPECT_EQ(text.number("object.0.dynamics.mass_g"), 7.0);
  EXPECT_EQ(text.number("object.1.radius_mm"), 5.0);
  EXPECT_FALSE(text.number("kind"));
  EXPECT_FALSE(text.number("mount"));
  EXPECT_FALSE(text.number("mount.translation_mm.3"));
  EXPECT_TRUE(text.is_same("object.ball.radius_mm", "object.0.radius_mm"));
  EXPECT_FALSE(text.is_same("object.0.radius_mm", "object.1.radius_mm"));
  EXPECT_THAT(text.words(), Contains("none"));
}

TEST(TomlText, ReplacesThemInPlace) {
  const TomlText text = toml_text();
  const std::string changed = text.with({{"object.ball.radius_mm", 12.25},
                                         {"speed", 2.0},
                                         {"mount.translation_mm.2", -0.1},
                                         {"a.b.inline.x", 1e-20}});
  const TomlText again("device.toml", changed);
  EXPECT_EQ(again.number("object.0.radius_mm"), 12.25);
  EXPECT_EQ(again.number("speed"), 2.0);
  EXPECT_EQ(again.number("mount.translation_mm.2"), -0.1);
  EXPECT_EQ(again.number("mount.translation_mm.1"), -2.0);
  EXPECT_EQ(again.number("a.b.inline.x"), 1e-20);
  EXPECT_THAT(changed, HasSubstr("speed = 2           # root"));
  EXPECT_EQ(std::ranges::count(changed, '\n'), std::ranges::count(text.text(), '\n'));
  EXPECT_EQ(text.with({}), text.text());
}

// To the last bit: a design is what the reader is given.
TEST(TomlText, WritesNumbersThatReadBackAlike) {
  for (const double value : {0.1, 1.0 / 3.0, 1e300, -5e-324, 123456789.123456789, 3.0}) {
    const TomlText again("device.toml", toml_text().with({{"speed", value}}));
    EXPECT_EQ(again.number("speed"), value);
  }
}

TEST(TomlText, PutsInWhatAFileLeavesOut) {
  TomlText text = toml_text();
  EXPECT_TRUE(text.add("mount.clearance_mm", 3.0));
  EXPECT_TRUE(text.add("rate", 1.0));
  EXPECT_TRUE(text.add("limits.max_force_N", 4.0));
  EXPECT_TRUE(text.add("home.pitch_deg", 4.0));
  EXPECT_TRUE(text.add("limits.max_tilt_deg", 4.0));
  EXPECT_TRUE(text.add("object.dynamics.velocity", 0.0) == false) << "which object?";
  EXPECT_FALSE(text.add("a.b.inline.z", 1.0)) << "its table is written inline";
  EXPECT_FALSE(text.add("a.shallow", 1.0)) << "has no heading of its own";
  EXPECT_FALSE(text.add("kind.of", 1.0)) << "is a text";
  EXPECT_FALSE(text.add("speed.of", 1.0)) << "is a number";
  EXPECT_EQ(text.number("mount.clearance_mm"), 3.0);
  const TomlText again("device.toml", text.with({{"limits.max_force_N", 9.5},
                                                 {"home.pitch_deg", 1.5},
                                                 {"limits.max_tilt_deg", 2.5},
                                                 {"mount.clearance_mm", 3.5},
                                                 {"rate", 4.5}}));
  EXPECT_EQ(again.number("limits.max_force_N"), 9.5);
  EXPECT_EQ(again.number("home.pitch_deg"), 1.5);
  EXPECT_EQ(again.number("limits.max_tilt_deg"), 2.5);
  EXPECT_EQ(again.number("mount.clearance_mm"), 3.5);
  EXPECT_EQ(again.number("rate"), 4.5);
  EXPECT_EQ(again.number("a.b.deep"), 4.0);
}

// What a reader says of a changed text names lines of the file.
TEST(TomlText, KeepsLines) {
  const ConfigFile changed("device.toml", toml_text().with({{"a.b.deep", -1.0}}));
  try {
    static_cast<void>(changed.root().table("a").table("b").number("deep", Range::positive()));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("device.toml:7: a.b.deep"));
  }
}

TEST(TomlText, RefusesWhatIsNoToml) {
  try {
    const TomlText text("device.toml", "a = \n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("device.toml:1: is not valid TOML"));
  }
}

}  // namespace
}  // namespace softfinger
