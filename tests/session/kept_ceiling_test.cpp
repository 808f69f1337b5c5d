#include "softfinger/session/kept_ceiling.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "../support/environment_variable.hpp"
#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/actuation/force_ceiling.hpp"
#include "softfinger/base/code_hash.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kForce = 2.0;  // N

fs::path shipped_file_of(const std::string& name) { return fs::path(source_folder()) / name; }

/// With a folder for caches of its own.
class KeptCeiling : public testing::Test {
 protected:
  [[nodiscard]] fs::path file() const { return kept_ceiling_file(*finger_, *device_, kForce); }
  [[nodiscard]] bool is_kept() const {
    return read_kept_ceiling(file(), *finger_, device_, kForce).has_value();
  }
  [[nodiscard]] static std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void put(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  TemporaryDirectory directory_;
  EnvironmentVariable caches_{"XDG_CACHE_HOME", directory_ / "caches"};
  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(shipped_file_of("fingers/index.toml"));
  std::shared_ptr<const Device> device_ = load_device(shipped_file_of("devices/plate-2dof.toml"));
};

TEST_F(KeptCeiling, IsThatWhichIsMade) {
  const TravelCeiling made = force_ceiling(*finger_, device_, kForce);
  EXPECT_FALSE(is_kept());
  for (const char* time : {"first", "second"}) {
    const TravelCeiling got = kept_force_ceiling(*finger_, device_, kForce);
    EXPECT_EQ(got.depths(), made.depths()) << time;
    EXPECT_EQ(got.travel(device_->home()), made.travel(device_->home())) << time;
    ASSERT_EQ(got.grid().size(), made.grid().size());
    EXPECT_TRUE(is_kept()) << time;
  }
  EXPECT_GT(*std::ranges::max_element(made.depths()), 0.5 * mm);
}

TEST_F(KeptCeiling, IsUsedWhereItIsThere) {
  static_cast<void>(kept_force_ceiling(*finger_, device_, kForce));
  // Who has been asked to end makes none, but may read one.
  std::stop_source ended;
  ended.request_stop();
  EXPECT_NO_THROW(
      static_cast<void>(kept_force_ceiling(*finger_, device_, kForce, ended.get_token())));
  fs::remove(file());
  EXPECT_ANY_THROW(
      static_cast<void>(kept_force_ceiling(*finger_, device_, kForce, ended.get_token())));
  EXPECT_FALSE(fs::exists(file())) << "what was broken off is not kept";
}

TEST_F(KeptCeiling, IsOfThisFingerDeviceAndLimitAlone) {
  std::set<fs::path> files{file(), kept_ceiling_file(*finger_, *device_, 1.01 * kForce)};
  std::size_t kinds = 2;
  const auto of_finger = [&](auto&& change) {
    FingerModel changed = *finger_;
    change(changed);
    files.insert(kept_ceiling_file(changed, *device_, kForce));
    EXPECT_EQ(files.size(), ++kinds);
  };
  of_finger([](FingerModel& m) { m.materials[0].youngs_modulus *= 1.001; });
  of_finger([](FingerModel& m) { m.materials[0].poissons_ratio += 1e-6; });
  of_finger([](FingerModel& m) { m.strain_limits.stiffness *= 1.001; });
  of_finger([](FingerModel& m) { m.strain_limits.min += 1e-6; });
  of_finger([](FingerModel& m) { m.strain_limits.max += 1e-6; });
  of_finger([](FingerModel& m) { m.strain_limits.width += 1e-6; });
  of_finger([](FingerModel& m) { m.dilatation = Dilatation::kElement; });
  of_finger([](FingerModel& m) { m.contact_tolerance *= 2.0; });
  of_finger([](FingerModel& m) { m.feature_contact = false; });
  of_finger([](FingerModel& m) { m.mesh.nodes[7].x() += 1e-9; });
  of_finger([](FingerModel& m) { std::swap(m.mesh.tetrahedra[0], m.mesh.tetrahedra[1]); });
  of_finger([](FingerModel& m) { m.node_is_rigid.flip(); });
  const auto of_device = [&](const std::shared_ptr<const Device>& other) {
    files.insert(kept_ceiling_file(*finger_, *other, kForce));
    EXPECT_EQ(files.size(), ++kinds);
  };
  of_device(load_device(shipped_file_of("devices/thimble-3rrs.toml")));
  of_device(load_device(shipped_file_of("devices/plate-2dof.toml"), 0.1 * mm));
}

TEST_F(KeptCeiling, DamagedIsMadeAnew) {
  const TravelCeiling made = kept_force_ceiling(*finger_, device_, kForce);
  const std::string whole = content(file());
  ASSERT_TRUE(is_kept());
  int noticed = 0;
  for (std::size_t at = 0; at < whole.size(); at += 3) {
    std::string spoilt = whole;
    spoilt[at] = spoilt[at] == '7' ? '3' : '7';
    put(file(), spoilt);
    if (!is_kept()) {
      ++noticed;
    } else {
      // A digit beyond those that a double has.
      EXPECT_EQ(read_kept_ceiling(file(), *finger_, device_, kForce)->depths(), made.depths());
    }
  }
  EXPECT_GT(noticed, static_cast<int>(whole.size()) / 4);
  for (const std::string& text : {std::string(), whole.substr(0, whole.size() / 2), whole + "1",
                                  std::string("[]"), std::string("{\"of\": -1}")}) {
    put(file(), text);
    EXPECT_FALSE(is_kept()) << text;
  }
  EXPECT_EQ(kept_force_ceiling(*finger_, device_, kForce).depths(), made.depths());
  EXPECT_EQ(content(file()), whole);
}

TEST_F(KeptCeiling, IsNotTakenFromWhereOthersMayWrite) {
  static_cast<void>(kept_force_ceiling(*finger_, device_, kForce));
  ASSERT_TRUE(is_kept());
  const fs::path folder = file().parent_path();
  for (const fs::path& place : {file(), folder}) {
    for (const fs::perms others : {fs::perms::group_write, fs::perms::others_write}) {
      fs::permissions(place, others, fs::perm_options::add);
      EXPECT_FALSE(is_kept()) << place;
      fs::permissions(place, others, fs::perm_options::remove);
      EXPECT_TRUE(is_kept());
    }
  }
}

TEST_F(KeptCeiling, IsKeptWhateverTheUmask) {
  const mode_t before = ::umask(0);
  static_cast<void>(kept_force_ceiling(*finger_, device_, kForce));
  ::umask(before);
  EXPECT_TRUE(is_kept());
}

TEST_F(KeptCeiling, NeedsAFolder) {
  const EnvironmentVariable caches("XDG_CACHE_HOME", "");
  const EnvironmentVariable home("HOME", "");
  EXPECT_EQ(file(), fs::path());
  EXPECT_FALSE(kept_force_ceiling(*finger_, device_, kForce).depths().empty());
}

TEST_F(KeptCeiling, TheCodeThatMakesItHasAHash) {
  EXPECT_NE(code_hash(), 0U);
  EXPECT_EQ(code_hash(), code_hash());
}

}  // namespace
}  // namespace softfinger
