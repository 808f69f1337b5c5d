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

/// A device with the section that was written in place of its own.
std::string with_section(const std::string& device, const std::string& section) {
  return device.substr(0, device.find("\n[transport]")) +
         section.substr(section.find("\n[transport]"));
}

// What it writes takes the place of the section it was made from, whatever was answered: it is read
// as it is, or it is not written.
TEST(CalibrateCommand, WritesASectionThatIsReadOrNone) {
  const Workplace place;
  int written = 0;
  int refused = 0;
  for (const std::string name : {"thimble-3rrs", "thimble-3rrs-feetech", "thimble-3rrs-osc"}) {
    const std::string device = place.path("devices/" + name + ".toml");
    for (const auto& [at, moved] :
         std::vector<std::pair<std::string, std::string>>{{"31.6,31.0,32.0", "10,10,10"},
                                                          {"31.6,31.6,31.6", "-10,10,10"},
                                                          {"1000,31.6,31.6", "10,10,10"},
                                                          {"31.6,31.6,31.6", "10,19,10"}}) {
      SCOPED_TRACE(name + " " + at + " " + moved);
      const std::string out = place.path(name + std::to_string(written + refused) + ".toml");
      const auto run =
          run_program({"device", "calibrate", device, "--out", out, "--at", at, "--moved", moved});
      if (run.status == 0) {
        ++written;
        EXPECT_THAT(run.output, HasSubstr("joint 3 reaches"));
        const std::string joined = place.path("joined.toml");
        place.write("joined.toml", with_section(text_of(device), text_of(out)));
        const auto shown = run_program({"device", "show", joined});
        EXPECT_EQ(shown.status, 0) << shown.errors;
        const auto again = run_program(
            {"device", "calibrate", device, "--out", out, "--at", at, "--moved", moved});
        EXPECT_EQ(again.status, 2);
        EXPECT_THAT(again.errors, HasSubstr("exists"));
      } else {
        ++refused;
        EXPECT_EQ(run.status, 2) << run.errors;
        EXPECT_EQ(run.output, "");
        EXPECT_THAT(run.errors, HasSubstr("not written"));
        EXPECT_FALSE(std::filesystem::exists(out));
      }
    }
  }
  EXPECT_GE(written, 3);
  EXPECT_GE(refused, 3);
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
