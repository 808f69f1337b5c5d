#include "softfinger/session/worn_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

std::shared_ptr<const FingerModel> finger(const char* name) {
  return FingerModel::load(fs::path(source_folder()) / "fingers" / (std::string(name) + ".toml"));
}

/// A shipped device with a change to its text.
class WornDevice : public testing::Test {
 protected:
  fs::path device(const std::string& name, const std::string& pattern = "",
                  const std::string& text = "") {
    std::ifstream shipped(fs::path(source_folder()) / "devices" / (name + ".toml"));
    std::string content{std::istreambuf_iterator<char>(shipped), {}};
    if (!pattern.empty()) {
      const std::string changed = std::regex_replace(content, std::regex(pattern), text,
                                                     std::regex_constants::format_first_only);
      EXPECT_NE(changed, content) << "nothing was changed";
      content = changed;
    }
    const fs::path file = directory_ / "device.toml";
    std::ofstream(file) << content;
    return file;
  }

  void expect_refused(const fs::path& file, const std::string& where, const std::string& why) {
    try {
      static_cast<void>(worn_on(*finger("index"), file));
      ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(where));
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }

  static double force_at_home(const FingerModel& model, const std::shared_ptr<const Device>& worn) {
    Twin twin(std::make_shared<FingerModel>(model), worn);
    twin.press(worn->home(), 0.5, 0.0);
    return twin.contact().normal_force;
  }

  TemporaryDirectory directory_;
};

TEST_F(WornDevice, FitsEveryFingerAndPressesNoneAtHome) {
  for (const char* name : {"index", "thumb", "middle", "ring", "pinky"}) {
    const auto model = finger(name);
    for (const char* kind : {"membrane", "pins-wagner-6x6", "plate-2dof"}) {
      const auto worn = worn_on(*model, device(kind)).device;
      EXPECT_EQ(force_at_home(*model, worn), 0.0) << name << ' ' << kind;
      if (std::string(name) == "index") {
        EXPECT_EQ(worn->settings().mount_shift, 0.0) << kind;
      }
    }
  }
  // A thumb is thicker: without the shift the membrane's ring would press it.
  const auto thumb = finger("thumb");
  EXPECT_GT(worn_on(*thumb, device("membrane")).device->settings().mount_shift, 0.5 * mm);
}

TEST_F(WornDevice, RefusesWhatRestsOnTheSkin) {
  for (const char* travel : {"3.02", "3.9", "4.5", "4.7"}) {
    expect_refused(device("thimble-3rrs", "\\[home\\][^\\[]*",
                          std::string("[home]\ntravel_mm = ") + travel + "\n\n"),
                   "home", "presses");
  }
  expect_refused(device("plate-2dof", "\\[retract\\][^\\[]*", "[retract]\ntravel_mm = 3.5\n\n"),
                 "retract", "presses");
}

TEST_F(WornDevice, RefusesWhatCannotTouch) {
  expect_refused(device("thimble-3rrs", "translation_mm = [^\\n]*\\nclearance_mm[^\\n]*",
                        "translation_mm = [1.0, 0.0, -1030.0]"),
                 "mount.translation_mm", "keeps the device from touching");
  expect_refused(
      device("thimble-3rrs", "translation_mm = [^\\n]*", "translation_mm = [1.0, 0.0, -1030.0]"),
      "mount.clearance_mm", "more than 5 mm");
}

TEST_F(WornDevice, TellsOfAnApproachThatHomeLeavesNoRoomFor) {
  EXPECT_TRUE(worn_on(*finger("index"), device("plate-2dof")).notices.empty());
  const auto worn = worn_on(*finger("index"),
                            device("plate-2dof", "approach_mm = [^\\n]*", "approach_mm = 10.0"));
  ASSERT_EQ(worn.notices.size(), 1u);
  EXPECT_EQ(worn.notices.front().key, "matching.approach_mm");
}

constexpr const char* kSliderCrank = R"toml(
kind = "mechanism"
[mount]
translation_mm = [1.0, 0.0, -10.3]
[[body]]
name = "plate"
[[joint]]
name = "drive"
type = "prismatic"
parent = "base"
child = "plate"
axis = [0.0, 0.0, SIGN]
actuated = true
joint_mm = [-6.0, 6.0]
[[surface]]
type = "disk"
body = "plate"
radius_mm = 8.0
[configuration]
way_mm = { joint = "drive" }
[limits]
joint_rate_mm_per_s = 50.0
[matching]
approach = "way_mm"
)toml";

TEST_F(WornDevice, RefusesAnAdvanceThatLeadsAway) {
  for (const char* sign : {"1.0", "-1.0"}) {
    const fs::path file = directory_ / "device.toml";
    std::ofstream(file) << std::regex_replace(kSliderCrank, std::regex("SIGN"), sign);
    if (sign[0] == '-') {
      expect_refused(file, "matching.approach", "does not bring the surface nearer");
    } else {
      EXPECT_NE(worn_on(*finger("index"), file).device, nullptr);
    }
  }
}

TEST_F(WornDevice, IsNoLongerLookedAtWhereNobodyWantsIt) {
  std::stop_source source;
  source.request_stop();
  try {
    // A limit that no table is kept for.
    const fs::path file = device("thimble-3rrs", "max_force_N = 4.7", "max_force_N = 4.6321");
    static_cast<void>(worn_on(*finger("index"), file, source.get_token()));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("is no longer wanted"));
  }
}

}  // namespace
}  // namespace softfinger
