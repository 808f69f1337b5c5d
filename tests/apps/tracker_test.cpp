// Trackers over the network and their emulators, as two commands of a user.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program.hpp"
#include "softfinger/wire/udp_socket.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Down on the ball and there to stay, as a CSV file.
std::string press_csv() {
  std::string text = "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
  for (int i = 0; i <= 40; ++i) {
    text += std::to_string(0.05 * i) + ",-2.5,0," + std::to_string(40.5 - std::min(i, 20) * 0.74) +
            ",1,0,0,0\n";
  }
  return text;
}

/// The port that an emulator says it listens at.
std::string port_said(const std::string& output) {
  const std::string before = "127.0.0.1:";
  const std::size_t begin = output.find(before) + before.size();
  return output.substr(begin, output.find_first_not_of("0123456789", begin) - begin);
}

std::string unused_port() { return std::to_string(UdpSocket({kLoopback, 0}).local().port); }

void expect_contact(const ProgramRun& run) {
  ASSERT_EQ(run.status, 0) << run.errors;
  const json report = json::parse(run.output);
  EXPECT_GT(report.at("max_contact_area_mm2"), 1.0);
  EXPECT_TRUE(report.at("pose_age_ms").at("p50").is_number());
}

class EmulatedNatNet : public testing::Test {
 protected:
  EmulatedNatNet() { place_.write("press.csv", press_csv()); }
  /// Starts an emulator of press.csv, or of another file, and says its port.
  std::string start(std::vector<std::string> more, const std::string& file = "press.csv") {
    std::vector<std::string> words{"emulate", "natnet", place_.path(file),
                                   "--port",  "0",      "--repeat"};
    words.insert(words.end(), more.begin(), more.end());
    emulator_ = std::make_unique<RunningProgram>(words);
    EXPECT_TRUE(emulator_->says("(Ctrl-C ends)", 20.0));
    return port_said(emulator_->output());
  }
  ProgramRun run(const std::string& tracker, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"run",        place_.path("scenes/sphere.toml"),
                                   "--headless", "--duration-s",
                                   "2",          "--tracker",
                                   tracker,      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  Workplace place_;
  std::unique_ptr<RunningProgram> emulator_;
};

TEST_F(EmulatedNatNet, DrivesARunThatReplays) {
  const std::string port = start({"--body", "finger tip", "--version", "3.1"});
  const std::string file = place_.path("run.db");
  expect_contact(run("natnet:127.0.0.1:" + port + ",body=finger tip", {"--record", file}));
  EXPECT_EQ(run_program({"replay", file}).status, 0);
  EXPECT_EQ(emulator_->stop(SIGINT).status, 0);
  // The recording is what another emulator may stream.
  expect_contact(run("natnet:127.0.0.1:" + start({"--up", "z"}, "run.db") + ",body=index,up=z"));
}

TEST_F(EmulatedNatNet, WrongBodyIsAnsweredWithThoseThereAre) {
  const std::string port = start({});
  expect_refused(run("natnet:127.0.0.1:" + port + ",body=thumb"),
                 {"no rigid body 'thumb'", "index"});
}

TEST_F(EmulatedNatNet, SilentHostIsDiagnosed) {
  const std::string port = unused_port();
  expect_refused(run("natnet:127.0.0.1:" + port + ",body=index"),
                 {"command socket is silent", "127.0.0.1:" + port, "firewall"});
}

TEST_F(EmulatedNatNet, BadFlagsAreRefused) {
  const std::string csv = place_.path("press.csv");
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--version", "2.7"},
                                             {"--version", "4"},
                                             {"--up", "x"},
                                             {"--body", "a,b"},
                                             {"--body", ""},
                                             {"--rate-Hz", "0"},
                                             {"--rate-Hz", "nan"},
                                             {"--finger", "thumb"},
                                             {"--address", "nowhere.invalid"},
                                             {"--port", "70000"}}) {
    std::vector<std::string> words{"emulate", "natnet", csv};
    words.insert(words.end(), flags.begin(), flags.end());
    expect_refused(run_program(words), {flags[0] == "--address" ? flags[1] : flags[0]});
  }
  expect_refused(run_program({"emulate", "natnet", place_.path("absent.csv")}), {"absent.csv"});
  expect_refused(run_program({"emulate", "udp", csv, "--port", "0"}), {"--port"});
}

TEST_F(EmulatedNatNet, EndsWithItsFile) {
  const ProgramRun sent =
      run_program({"emulate", "udp", place_.path("press.csv"), "--port", unused_port()});
  EXPECT_EQ(sent.status, 0) << sent.errors;
}

TEST(EmulatedSender, UdpAndOscDriveARun) {
  const Workplace place;
  place.write("press.csv", press_csv());
  for (const std::string kind : {"udp", "osc"}) {
    const std::string port = unused_port();
    RunningProgram sender({"emulate", kind, place.path("press.csv"), "--port", port, "--repeat"});
    ASSERT_TRUE(sender.says("sends poses to 127.0.0.1:" + port, 20.0));
    expect_contact(run_program({"run", place.path("scenes/sphere.toml"), "--headless",
                                "--duration-s", "4", "--tracker", kind + ":" + port, "--json"}));
    EXPECT_EQ(sender.stop(SIGTERM).status, 0);
  }
}

TEST(NetworkTrackerCommand, PortInUseAndRunsAsFastAsPossibleAreRefused) {
  const Workplace place;
  const UdpSocket taken({kLoopback, 0});
  const std::string port = std::to_string(taken.local().port);
  const std::string scene = place.path("scenes/sphere.toml");
  expect_refused(run_program({"run", scene, "--headless", "--tracker", "udp:" + port}),
                 {"udp:" + port, "in use"});
  expect_refused(run_program({"run", scene, "--headless", "--as-fast-as-possible", "--tracker",
                              "osc:" + unused_port()}),
                 {"osc:", "as fast as possible"});
  expect_refused(run_program({"run", scene, "--headless", "--tracker", "udp:70000"}),
                 {"udp:70000", "udp:ADDRESS:PORT"});
}

TEST(ConditionCommand, SaysWhatFilterAndPredictionMakeOfAMotion) {
  const Workplace place;
  place.write("press.csv", press_csv());
  const std::string file = place.path("press.csv");
  const ProgramRun run = run_program(
      {"condition", file, "--predict-ms", "0", "--noise-mm", "0", "--noise-deg", "0", "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const json report = json::parse(run.output);
  // A press at 15 mm/s, seen 15 ms late and played an interval of 8 ms behind; then rest.
  const json& moving = report.at("moving");
  EXPECT_NEAR(moving.at("time_s").get<double>(), 1.0, 0.05);
  EXPECT_NEAR(moving.at("before").at("distance_mm").get<double>(), 14.8 * 0.0233, 0.03);
  EXPECT_LT(moving.at("after").at("distance_mm"), moving.at("before").at("distance_mm"));
  EXPECT_TRUE(report.at("resting").at("after").at("turn_deg").is_number());
}

TEST(ConditionCommand, RefusesWhatItCannotDo) {
  const Workplace place;
  place.write("press.csv", press_csv());
  const std::string file = place.path("press.csv");
  expect_refused(run_program({"condition", file}), {"--filter", "--predict-ms"});
  expect_refused(run_program({"condition", file, "--filter", "--rate-Hz", "0"}), {"--rate-Hz 0"});
  expect_refused(run_program({"condition", file, "--filter", "--noise-mm", "nan"}), {"--noise-mm"});
  expect_refused(run_program({"condition", place.path("none.csv"), "--filter"}), {"none.csv"});
}

}  // namespace
}  // namespace softfinger
