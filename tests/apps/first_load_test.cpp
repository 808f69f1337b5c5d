// Ctrl-C and its like while the first scene loads: nothing is open yet, and the program ends at
// once.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../support/child_process.hpp"
#include "../support/large_mesh.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

/// A scene with a mesh whose import never comes to its end.
class EndlessFirstLoad : public testing::Test {
 protected:
  EndlessFirstLoad() {
    place.write("scenes/large.obj", text_of_large_mesh());
    place.replace_line("scenes/relief.toml", "file =", "file = \"large.obj\"");
  }

  /// Sends the signal while the mesh is imported, and expects an end soon, of the import as well.
  ProgramRun interrupted(int signal, const std::vector<std::string>& words) {
    RunningProgram program(words);
    const pid_t import = child_of(program.process());
    EXPECT_GT(import, 0);
    EXPECT_EQ(::kill(import, SIGSTOP), 0);
    const auto sent = std::chrono::steady_clock::now();
    ProgramRun run = program.stop(signal);
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(2));
    EXPECT_EQ(::kill(import, 0), -1);
    EXPECT_FALSE(std::filesystem::exists(place.path("scenes/.softfinger-cache")));
    return run;
  }

  Workplace place;
  std::string scene = place.path("scenes/relief.toml");
};

TEST_F(EndlessFirstLoad, EndsByASignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const ProgramRun run = interrupted(signal, {"run", scene, "--port", "0"});
    EXPECT_EQ(run.status, 0) << signal;
    EXPECT_EQ(run.output, "");
    EXPECT_EQ(run.errors, "softfinger: ended while the scene was loading\n");
  }
}

TEST_F(EndlessFirstLoad, ReportsNoStepsInJson) {
  const std::string file = place.path("run.db");
  const ProgramRun run =
      interrupted(SIGTERM, {"run", scene, "--headless", "--record", file, "--json"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(nlohmann::json::parse(run.output).at("steps"), 0);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(EndlessFirstLoad, LeavesNothingToJudge) {
  const ProgramRun run = interrupted(SIGINT, {"evaluate", scene});
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(run.errors, "softfinger: evaluate: ended while the scene was loading\n");
}

}  // namespace
}  // namespace softfinger
