#include "softfinger/files/config_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class ConfigFileTest : public ::testing::Test {
 protected:
  ConfigFile open(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return ConfigFile(file_);
  }
  /// The one line thrown by reading `text` as `read` does, without the file's name.
  std::string error(const std::string& text, const std::function<void(const ConfigTable&)>& read) {
    try {
      read(open(text).root());
    } catch (const InputError& thrown) {
      const std::string message = thrown.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.rfind(file_.string(), 0), 0u) << message;
      return message.substr(file_.string().size());
    }
    ADD_FAILURE() << "nothing thrown for: " << text;
    return {};
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::filesystem::path file_ =
      std::filesystem::path(::testing::TempDir()) /
      (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".toml");
};

TEST_F(ConfigFileTest, ConvertsUnitsToSi) {
  const ConfigTable root =
      open("radius_mm = 20\npitch_deg = 180.0\nforce_N = 4.7\nsize_mm = [1, 2.5, 3]\n").root();
  EXPECT_DOUBLE_EQ(root.number("radius_mm"), 0.02);
  EXPECT_DOUBLE_EQ(root.number("pitch_deg"), 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(root.number("force_N"), 4.7);
  EXPECT_TRUE(root.numbers("size_mm", 3).isApprox(Eigen::Vector3d(1e-3, 2.5e-3, 3e-3)));
  root.finish();
}

TEST_F(ConfigFileTest, ReadsTextsAndTellsTablesFromOtherKeys) {
  const ConfigFile file = open("scenes = [\"plane\", \"edge\"]\nvary = 3\n[design]\nsize = 3\n");
  const ConfigTable root = file.root();
  EXPECT_THAT(root.texts("scenes"), ElementsAre("plane", "edge"));
  EXPECT_TRUE(root.has_table("design"));
  EXPECT_FALSE(root.has_table("vary"));
  EXPECT_FALSE(root.has_table("none"));
  EXPECT_EQ(nlohmann::json::parse(file.as_read()).at("scenes").size(), 2u);
  const auto texts = [](const ConfigTable& table) { static_cast<void>(table.texts("scenes")); };
  EXPECT_THAT(error("scenes = [\"a\", 2]\n", texts),
              HasSubstr(":1: scenes: expected an array of texts in quotes"));
  EXPECT_THAT(error("scenes = []\n", texts), HasSubstr("found an array of 0"));
  EXPECT_THAT(error("scenes = \"a\"\n", texts), HasSubstr("found the text"));
  EXPECT_THAT(error("other = 1\n", texts), HasSubstr("scenes"));
}

TEST_F(ConfigFileTest, UnknownKeyNamesTheNearestAndItsLine) {
  EXPECT_EQ(error("[ball]\n\nradius_cm = 2\n",
                  [](const ConfigTable& root) {
                    root.table("ball").number("radius_mm", Range::positive(), 0.01);
                    root.finish();
                  }),
            ":3: ball.radius_cm: unknown key 'radius_cm'; did you mean 'radius_mm'?");
}

TEST_F(ConfigFileTest, UnknownKeyIsNamedWhereTheRightOneIsRequired) {
  EXPECT_EQ(error("\nradius_cm = 2\n", [](const ConfigTable& root) { root.number("radius_mm"); }),
            ":2: radius_cm: unknown key 'radius_cm'; did you mean 'radius_mm'?");
}

TEST_F(ConfigFileTest, UnknownKeyWithoutNeighbourListsTheKnownOnes) {
  EXPECT_EQ(error("colour = 'red'\n",
                  [](const ConfigTable& root) {
                    root.number("radius_mm", Range::any(), 1.0);
                    root.text("name", "x");
                    root.finish();
                  }),
            ":1: colour: unknown key 'colour'; known keys: radius_mm, name");
}

TEST_F(ConfigFileTest, UnknownKeyInElementOfArrayOfTables) {
  EXPECT_EQ(error("[[object]]\nname = 'a'\n[[object]]\nnmae = 'b'\n",
                  [](const ConfigTable& root) {
                    for (const ConfigTable& object : root.tables("object")) object.text("name", "");
                    root.finish();
                  }),
            ":4: object[1].nmae: unknown key 'nmae'; did you mean 'name'?");
}

TEST_F(ConfigFileTest, UnknownTableIsAnUnknownKey) {
  EXPECT_THAT(error("[materials]\nx = 1\n",
                    [](const ConfigTable& root) {
                      root.optional_table("material");
                      root.finish();
                    }),
              HasSubstr("unknown key 'materials'; did you mean 'material'?"));
}

TEST_F(ConfigFileTest, WrongTypesSayWhatWasFoundAndWhatIsExpected) {
  const auto number = [](const ConfigTable& root) { root.number("x_mm"); };
  EXPECT_EQ(error("x_mm = \"abc\"", number), ":1: x_mm: expected a number, found the text \"abc\"");
  EXPECT_THAT(error("x_mm = true", number), EndsWith("expected a number, found true"));
  EXPECT_THAT(error("x_mm = [1]", number), EndsWith("expected a number, found an array of 1"));
  EXPECT_THAT(error("x_mm = 2020-01-01", number), EndsWith("found a date or time"));
  EXPECT_THAT(error("n = 1.5", [](const ConfigTable& root) { root.integer("n", 0, 9); }),
              EndsWith("expected a whole number, found the number 1.5"));
  EXPECT_THAT(error("on = 1", [](const ConfigTable& root) { root.boolean("on", false); }),
              EndsWith("expected true or false, found the number 1"));
  EXPECT_THAT(error("name = 3", [](const ConfigTable& root) { root.text("name"); }),
              EndsWith("expected a text in quotes, found the number 3"));
  EXPECT_THAT(error("p_mm = [1, 2]", [](const ConfigTable& root) { root.numbers("p_mm", 3); }),
              EndsWith("expected an array of 3 numbers, found an array of 2"));
  EXPECT_THAT(error("p_mm = [1, 'b', 3]", [](const ConfigTable& r) { r.numbers("p_mm", 3); }),
              HasSubstr("p_mm[1]: expected a number, found the text \"b\""));
  EXPECT_THAT(error("mesh = 1", [](const ConfigTable& root) { root.table("mesh"); }),
              EndsWith("expected a table, [mesh], found the number 1"));
  EXPECT_THAT(error("[object]\na = 1", [](const ConfigTable& root) { root.tables("object"); }),
              EndsWith("expected an array of tables, [[object]], found a table"));
}

TEST_F(ConfigFileTest, RefusesWhatIsNotFinite) {
  for (const std::string value : {"nan", "-nan", "inf", "-inf"}) {
    EXPECT_THAT(error("x = " + value, [](const ConfigTable& root) { root.number("x"); }),
                HasSubstr("expected a finite number"));
    EXPECT_THAT(error("x = [0, " + value + "]", [](const ConfigTable& r) { r.numbers("x", 2); }),
                HasSubstr("x[1]: expected a finite number"));
  }
}

TEST_F(ConfigFileTest, RangesAreInTheUnitOfTheFile) {
  const auto positive = [](const ConfigTable& root) { root.number("r_mm", Range::positive()); };
  EXPECT_EQ(error("r_mm = -3", positive), ":1: r_mm: must be greater than 0, found -3");
  EXPECT_EQ(error("r_mm = 0.0", positive), ":1: r_mm: must be greater than 0, found 0");
  EXPECT_EQ(error("nu = 0.5",
                  [](const ConfigTable& root) { root.number("nu", Range::inside(0.0, 0.5)); }),
            ":1: nu: must be greater than 0 and less than 0.5, found 0.5");
  EXPECT_DOUBLE_EQ(open("r_mm = 30").root().number("r_mm", Range::between(10, 30)), 0.03);
  EXPECT_THAT(error("n = 12", [](const ConfigTable& root) { root.integer("n", 0, 11); }),
              EndsWith("must be between 0 and 11, found 12"));
}

TEST_F(ConfigFileTest, MissingKeys) {
  EXPECT_EQ(error("[a]\nb = 1\n", [](const ConfigTable& root) { root.table("a").number("x_mm"); }),
            ":1: a.x_mm: missing; expected a number");
  EXPECT_EQ(error("crank_mm = 1\n", [](const ConfigTable& root) { root.number("crnak_mm"); }),
            ":1: crank_mm: unknown key 'crank_mm'; did you mean 'crnak_mm'?");
  EXPECT_EQ(error("", [](const ConfigTable& root) { root.table("mesh"); }),
            ": mesh: missing; expected a table, [mesh]");
}

TEST_F(ConfigFileTest, Choices) {
  const std::vector<std::string> choices{"plane", "sphere"};
  EXPECT_EQ(
      error("shape = 'sphear'", [&](const ConfigTable& root) { root.choice("shape", choices); }),
      ":1: shape: unknown value 'sphear'; did you mean 'sphere'? expected one of: plane, "
      "sphere");
  EXPECT_EQ(open("").root().choice("shape", choices, "plane"), "plane");
}

TEST_F(ConfigFileTest, AsReadKeepsUnitsNestingAndDefaults) {
  const ConfigFile config = open(
      "radius_mm = 20\nfile = 'a/b.msh'\n[[finger]]\nname = 'index'\n"
      "[[finger.waypoint]]\ntime_s = 1.5\n[[finger.waypoint]]\ntime_s = 2\n");
  const ConfigTable root = config.root();
  root.number("radius_mm");
  EXPECT_EQ(root.path("file"), file_.parent_path() / "a/b.msh");
  const ConfigTable contact = root.table_or_empty("contact");
  contact.number("tolerance_mm", Range::positive(), 5e-5);
  contact.numbers("offset_deg", 2, Range::any(), Eigen::Vector2d(0.0, 30.0 * 0.017453292519943295));
  root.optional_number("absent_mm");
  root.optional_table("absent");
  for (const ConfigTable& finger : root.tables("finger")) {
    finger.text("name");
    finger.boolean("soft", true);
    for (const ConfigTable& waypoint : finger.tables("waypoint")) waypoint.number("time_s");
  }
  root.finish();
  EXPECT_EQ(nlohmann::json::parse(config.as_read()), nlohmann::json::parse(R"({
    "radius_mm": 20, "file": "a/b.msh", "contact": {"tolerance_mm": 0.05, "offset_deg": [0, 30]},
    "finger": [{"name": "index", "soft": true,
                "waypoint": [{"time_s": 1.5}, {"time_s": 2}]}]})"));
  EXPECT_EQ(config.as_read().find("radius_mm"), config.as_read().find('"') + 1);
}

TEST_F(ConfigFileTest, KeysInFileOrder) {
  const ConfigTable root = open("b = 1\na = 2\n[z]\nq = 1\n[c]\n").root();
  EXPECT_THAT(root.keys(), ElementsAre("b", "a", "z", "c"));
  EXPECT_TRUE(root.has("a"));
  EXPECT_FALSE(root.has("d"));
}

TEST_F(ConfigFileTest, RefusesWhatIsNoToml) {
  const auto nothing = [](const ConfigTable&) {};
  EXPECT_THAT(error("a = 1\nb = = 2\n", nothing), HasSubstr(":2: is not valid TOML at column"));
  EXPECT_THAT(error("a = 1\na = 2\n", nothing), HasSubstr(":2: a key or table is given twice"));
  EXPECT_THAT(error("a = \"\xff\xfe\"\n", nothing), HasSubstr("is not UTF-8 text"));
  EXPECT_THAT(error(std::string("\0\0\0", 3), nothing), HasSubstr(":1: is not valid TOML"));
  EXPECT_THAT(error(std::string(100000, '['), nothing), HasSubstr(":1: "));
  EXPECT_THAT(error("a = 1e999999\n", [](const ConfigTable& root) { root.number("a"); }),
              HasSubstr(":1: "));
}

TEST_F(ConfigFileTest, RefusesFilesThatCannotBeRead) {
  const auto message = [](const std::filesystem::path& file) {
    try {
      ConfigFile config(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message(file_.string() + ".absent"), EndsWith(": no such file"));
  EXPECT_THAT(message(::testing::TempDir()), HasSubstr("is a directory"));
  std::ofstream(file_) << "# " << std::string(5u << 20, 'x') << "\n";
  EXPECT_THAT(message(file_), HasSubstr("larger than 4 MB"));
}

TEST_F(ConfigFileTest, FailNamesLineAndKey) {
  EXPECT_EQ(error("[a]\nb = 1\n", [](const ConfigTable& root) { root.table("a").fail("b", "no"); }),
            ":2: a.b: no");
  EXPECT_EQ(error("[a]\nb = 1\n", [](const ConfigTable& root) { root.table("a").fail("", "no"); }),
            ":1: a: no");
}

TEST(NearestWord, FindsMisspellingsOnly) {
  const std::vector<std::string> words{"radius_mm", "rate_Hz", "min", "max"};
  EXPECT_EQ(nearest_word("radius_cm", words), "radius_mm");
  EXPECT_EQ(nearest_word("raduis_mm", words), "radius_mm");
  EXPECT_EQ(nearest_word("radius", words), "radius_mm");
  EXPECT_EQ(nearest_word("rate_hz", words), "rate_Hz");
  EXPECT_EQ(nearest_word("min", {"max"}), "");
  EXPECT_EQ(nearest_word("friction_coefficient", words), "");
}

}  // namespace
}  // namespace softfinger
