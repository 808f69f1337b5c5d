// Shipped files by name, from any folder and from where a program is installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "help_text.hpp"
#include "program.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

/// A command in a folder of its own, with none of its files there.
ProgramRun run_elsewhere(const std::vector<std::string>& arguments) {
  const TemporaryDirectory folder;
  return run_in_shell("cd '" + (folder / "").string() + "' && exec \"$@\"", arguments);
}

TEST(ShippedNames, EveryCommandTakesThem) {
  const std::vector<std::vector<std::string>> commands{
      {"run", "edge", "--headless", "--as-fast-as-possible", "--duration-s", "0.01", "--wearer",
       "thumb", "--device", "index=membrane"},
      {"evaluate", "plane", "--device", "plate-2dof", "--wearer", "index", "--duration-s", "0.1"},
      {"press", "index", "--steps", "1", "--to-mm", "0.1"},
      {"device", "show", "membrane"},
      {"device", "schema", "thimble-3rrs"},
      {"finger", "show", "index"},
      {"scene", "check", "sphere"}};
  for (const std::vector<std::string>& command : commands) {
    const ProgramRun run = run_elsewhere(command);
    EXPECT_EQ(run.status, 0) << testing::PrintToString(command) << run.errors;
    EXPECT_NE(run.output, "");
  }
}

TEST(ShippedNames, AreRefusedWithThoseThereAre) {
  expect_refused(
      run_elsewhere({"run", "spere"}),
      {"spere: no such file, nor a scene of that name in ", "/scenes, which has sphere"});
  expect_refused(run_elsewhere({"evaluate", "sphere", "--device", "membran"}),
                 {"membran: no such file, nor a device", "which has membrane"});
  expect_refused(run_elsewhere({"match", "thimble", "--points", "none.json"}),
                 {"thimble: no such file, nor a device", "thimble-3rrs-osc"});
  expect_refused(run_elsewhere({"press", "toe"}), {"toe: no such file, nor a finger", "index"});
}

TEST(ShippedNames, APathIsRefusedInTheOldWords) {
  EXPECT_EQ(run_elsewhere({"press", "toe.toml"}).errors, "softfinger: toe.toml: no such file\n");
  EXPECT_EQ(run_elsewhere({"run", "./sphere"}).errors, "softfinger: ./sphere: no such file\n");
}

/// As a package lays it out; the program is found by PATH, under no path of its own.
TEST(ShippedNames, AreFoundBesideTheProgram) {
  const TemporaryDirectory prefix;
  fs::create_directories(prefix / "bin");
  fs::create_directories(prefix / "share/softfinger");
  fs::copy_file(build_folder() + "/softfinger", prefix / "bin/softfinger");
  const std::string line =
      "cd / && PATH='" + (prefix / "bin").string() + "':$PATH && exec softfinger \"${@:2}\"";
  const ProgramRun lacking = run_in_shell(line, {"press", "own"});
  expect_refused(lacking, {"own: no such file, and no share/softfinger/fingers beside ",
                           (prefix / "bin").string()});
  fs::create_directory_symlink(source_folder() + "/devices", prefix / "share/softfinger/devices");
  fs::create_directories(prefix / "share/softfinger/scenes");
  fs::copy_file(source_folder() + "/devices/membrane.toml",
                prefix / "share/softfinger/scenes/own.toml");
  // Read as a scene, it is none: found it was.
  EXPECT_THAT(run_in_shell(line, {"scene", "check", "own"}).errors,
              StartsWith("softfinger: " + (prefix / "share/softfinger/scenes/own.toml").string()));
  EXPECT_EQ(run_in_shell(line, {"device", "show", "membrane"}).status, 0);
}

}  // namespace
}  // namespace softfinger
