#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "program.hpp"
#include "workplace.hpp"

namespace {

using softfinger::run_program;
using softfinger::Workplace;
using testing::HasSubstr;

std::string text_of(const std::string& file) {
  std::ifstream input(file);
  return {std::istreambuf_iterator<char>(input), {}};
}

// What it writes takes the place of the section it was made from.
TEST(CalibrateCommand, WritesASectionThatIsRead) {
  const Workplace place;
  for (const std::string name : {"thimble-3rrs", "thimble-3rrs-feetech"}) {
    const std::string device = place.path("devices/" + name + ".toml");
    const std::string out = place.path(name + "-servos.toml");
    // Joints stand at 5, 0 and -5 degrees of what they should; the second turns the other way.
    const auto run = run_program(
        {"device", "calibrate", device, "--out", out, "--at", "15,10,5", "--moved", "10,-10,11"});
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("joint 3 reaches"));
    const std::string whole = text_of(device);
    const std::string calibrated = text_of(out);
    EXPECT_THAT(calibrated, HasSubstr("per_deg = -1"));
    const std::string joined = place.path(name + "-new.toml");
    std::ofstream(joined) << whole.substr(0, whole.find("\n[transport]"))
                          << calibrated.substr(calibrated.find("\n[transport]"));
    const auto shown = run_program({"device", "show", joined});
    // Either it is read, or what it says is that the servo now does not reach the joint's limits.
    if (shown.status != 0) {
      EXPECT_THAT(shown.errors, HasSubstr("widen them or narrow the joint's limits"));
    }
    const auto again = run_program(
        {"device", "calibrate", device, "--out", out, "--at", "0,0,0", "--moved", "10,10,10"});
    EXPECT_EQ(again.status, 2);
    EXPECT_THAT(again.errors, HasSubstr("exists"));
    EXPECT_EQ(text_of(out), calibrated);
  }
}

TEST(CalibrateCommand, RefusesBadAnswers) {
  const Workplace place;
  const std::string device = place.path("devices/thimble-3rrs.toml");
  const std::string out = place.path("servos.toml");
  const auto refusal = [&](const std::string& at, const std::string& moved) {
    const auto run =
        run_program({"device", "calibrate", device, "--out", out, "--at", at, "--moved", moved});
    EXPECT_EQ(run.status, 2);
    EXPECT_FALSE(std::filesystem::exists(out));
    return run.errors;
  };
  EXPECT_THAT(refusal("1,2", "10,10,10"), HasSubstr("3 numbers"));
  EXPECT_THAT(refusal("0,0,0", "10,0,10"), HasSubstr("joint 2"));
  EXPECT_THAT(refusal("nan,0,0", "10,10,10"), HasSubstr("finite"));
  EXPECT_THAT(refusal("0,0,0", "10,inf,10"), HasSubstr("finite"));
  // Nobody answers on the standard input.
  const auto run = run_program({"device", "calibrate", device, "--out", out});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.errors, HasSubstr("--at"));
}

}  // namespace
