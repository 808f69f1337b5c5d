// A word means a file of that name first, then a shipped one; a path is left alone.
#include "softfinger/files/shipped_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string refusal_of(Shipped kind, const std::string& word) {
  try {
    return "found " + file_or_shipped(kind, word).string();
  } catch (const InputError& error) {
    return error.what();
  }
}

/// Stands in an empty folder meanwhile.
class ShippedFile : public testing::Test {
 protected:
  ShippedFile() { fs::current_path(here_ / ""); }
  ~ShippedFile() override { fs::current_path(before_); }

 private:
  TemporaryDirectory here_;
  fs::path before_ = fs::current_path();
};

TEST_F(ShippedFile, EveryOneIsFoundByName) {
  const fs::path source = source_folder();
  for (const auto& [kind, folder] : {std::pair{Shipped::kScene, "scenes"},
                                     {Shipped::kDevice, "devices"},
                                     {Shipped::kFinger, "fingers"}}) {
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(source / folder)) {
      if (entry.path().extension() != ".toml") continue;
      ++files;
      EXPECT_TRUE(fs::equivalent(file_or_shipped(kind, entry.path().stem().string()), entry.path()))
          << entry.path();
    }
    EXPECT_GT(files, 3u) << folder;
    EXPECT_EQ(shipped_names(kind).size(), files) << folder;
  }
}

TEST_F(ShippedFile, AFileOfThatNameGoesFirst) {
  std::ofstream("sphere") << "mine";
  EXPECT_EQ(file_or_shipped(Shipped::kScene, "sphere"), "sphere");
  EXPECT_TRUE(file_or_shipped(Shipped::kScene, "edge").is_absolute());
}

TEST_F(ShippedFile, AFolderOfThatNameDoesNot) {
  fs::create_directory("sphere");
  fs::create_directory("mine");
  EXPECT_TRUE(file_or_shipped(Shipped::kScene, "sphere").is_absolute());
  EXPECT_EQ(file_or_shipped(Shipped::kScene, "mine"), "mine");
}

TEST_F(ShippedFile, PathsAreLeftAlone) {
  for (const char* path : {"", ".", "sphere.toml", "./sphere", "scenes/sphere", "/sphere"}) {
    EXPECT_EQ(file_or_shipped(Shipped::kScene, path), path);
  }
}

TEST_F(ShippedFile, ARefusalSaysWhereItLookedAndWhatIsNear) {
  EXPECT_THAT(refusal_of(Shipped::kScene, "spere"),
              AllOf(StartsWith("spere: no such file, nor a scene of that name in /"),
                    HasSubstr("/scenes, which has sphere"), Not(HasSubstr("corner"))));
  // A device's name is not a scene's.
  EXPECT_THAT(
      refusal_of(Shipped::kScene, "membrane"),
      AllOf(HasSubstr("membrane: no such file"), HasSubstr("button, corner, cup, cylinder")));
  EXPECT_THAT(
      refusal_of(Shipped::kDevice, "3rrs"),
      AllOf(HasSubstr("nor a device"), HasSubstr("has thimble-3rrs, thimble-3rrs-dynamixel")));
  EXPECT_THAT(refusal_of(Shipped::kFinger, "indx"),
              AllOf(HasSubstr("nor a finger"), HasSubstr("has index")));
}

TEST(NamesNear, ThatContainTheWordElseTheNearestElseAll) {
  const std::vector<std::string> names{"edge", "slide", "sphere"};
  EXPECT_THAT(names_near("s", names), ElementsAre("slide", "sphere"));
  EXPECT_THAT(names_near("edgy", names), ElementsAre("edge"));
  EXPECT_THAT(names_near("quarter", names), ElementsAre("edge", "slide", "sphere"));
  EXPECT_THAT(names_near("", names), ElementsAre("edge", "slide", "sphere"));
}

}  // namespace
}  // namespace softfinger
