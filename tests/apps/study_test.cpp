// `study` as its users call it: alone, by mpirun, in shards, killed and resumed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "../support/child_process.hpp"
#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "../viewer/raw_client.hpp"
#include "program.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

/// A folder with a study whose designs take a few milliseconds each.
class StudyCommand : public testing::Test {
 protected:
  StudyCommand() { write(60); }
  void write(int designs) const {
    std::ofstream(folder_ / "study.toml") << R"toml(device = "thimble-3rrs"
[vary]
device.geometry.crank_mm = { min = 5, max = 15 }
device.geometry.coupler_mm = { tie = "2 * device.geometry.crank_mm" }
device.geometry.disk_radius_mm = { values = [6, 8, 10] }
[objectives]
size = { formula = "device.geometry.crank_mm + device.geometry.disk_radius_mm" }
[design]
kind = "lhs"
)toml"
                                          << "size = " << designs << "\n";
  }
  [[nodiscard]] std::string path(const char* name) const { return folder_ / name; }
  [[nodiscard]] std::vector<std::string> into(const char* out) const {
    return {"study", path("study.toml"), "--out", path(out)};
  }
  /// The table of a study's folder.
  [[nodiscard]] std::string csv(const char* out) const {
    const std::string file = path(out) + ".csv";
    fs::remove(file);
    const ProgramRun run = run_program({"study", "export", path(out), "--to", file});
    EXPECT_EQ(run.status, 0) << run.errors;
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] static std::string mpirun(int ranks) {
    return fmt::format("exec mpirun --allow-run-as-root --oversubscribe -n {} \"$@\"", ranks);
  }

  TemporaryDirectory folder_;
};

bool has_mpi() {
  const fs::path beside = fs::path(build_folder()) / "softfinger-mpi.so";
  return fs::exists(beside) && std::system("command -v mpirun >/dev/null") == 0;
}

TEST_F(StudyCommand, OneCommandAloneByMpirunAndInShardsGivesTheSameBytes) {
  const ProgramRun alone = run_program(into("alone"));
  EXPECT_EQ(alone.status, 0) << alone.errors;
  EXPECT_THAT(alone.output, StartsWith("60 designs, "));
  const std::string table = csv("alone");
  EXPECT_THAT(table, HasSubstr("\n59,"));
  EXPECT_THAT(table, HasSubstr(",false,\"thimble-3rrs:")) << "short cranks cannot be";
  EXPECT_THAT(table, HasSubstr(",true,"));
  for (int shard = 1; shard <= 3; ++shard) {
    std::vector<std::string> words = into("shards");
    words.insert(words.end(), {"--shard", fmt::format("{}/3", shard)});
    const ProgramRun run = run_program(words);
    EXPECT_EQ(run.status, 0) << run.errors;
  }
  const ProgramRun merged = run_program(into("shards"));
  EXPECT_THAT(merged.output, HasSubstr("60 of 60 evaluations were known before"));
  EXPECT_EQ(csv("shards"), table);
  if (!has_mpi()) GTEST_SKIP() << "built without MPI";
  for (const int ranks : {1, 2, 3}) {
    const std::string out = fmt::format("ranks{}", ranks);
    const ProgramRun run = run_in_shell(mpirun(ranks), into(out.c_str()));
    EXPECT_EQ(run.status, 0) << run.errors;
    EXPECT_THAT(run.output, StartsWith("60 designs, ")) << "of one rank alone";
    EXPECT_EQ(csv(out.c_str()), table) << ranks;
  }
}

/// Evaluations recorded so far.
std::size_t recorded_in(const ProgramRun& run) {
  const std::size_t begin = run.output.find("; ");
  return begin == std::string::npos ? 0 : std::stoul(run.output.substr(begin + 2));
}

/// Of a child that nobody has waited for.
bool has_ended(pid_t child) {
  siginfo_t found{};
  return ::waitid(P_PID, static_cast<id_t>(child), &found, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         found.si_pid == child;
}

TEST_F(StudyCommand, WhateverIsKilledItGoesOn) {
  static_cast<void>(run_program(into("alone")));
  // At instants a few evaluations apart, once it has begun.
  const fs::path journal = path("killed") + std::string("/journal.sqlite");
  for (int k = 1; k <= 6; ++k) {
    RunningProgram program(into("killed"));
    for (int i = 0; i < 2000 && !fs::exists(journal); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + 60 * k));
    // However slow the machine is, the last one has recorded some.
    std::error_code error;
    const std::string log = journal.string() + "-wal";
    for (int i = 0; k == 6 && i < 4000 && !has_ended(program.process()); ++i) {
      if (fs::exists(log, error) && fs::file_size(log, error) >= 150'000) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    static_cast<void>(program.stop(SIGKILL));
  }
  const ProgramRun last = run_program(into("killed"));
  EXPECT_EQ(last.status, 0) << last.errors;
  EXPECT_GT(recorded_in(last), 0u) << last.output;
  EXPECT_EQ(csv("killed"), csv("alone"));
}

TEST_F(StudyCommand, AnyRankMayBeKilled) {
  if (!has_mpi()) GTEST_SKIP() << "built without MPI";
  write(200);
  static_cast<void>(run_program(into("alone")));
  for (const int which : {1, 0}) {
    RunningProgram job(into("killed"), mpirun(2));
    // The ranks are the children of mpirun; the first one found, or the last one started.
    const pid_t first = child_of(job.process());
    ASSERT_NE(first, 0);
    // Until some are recorded.
    const fs::path log = path("killed") + std::string("/journal.sqlite-wal");
    std::error_code error;
    for (int k = 0; k < 4000 && (!fs::exists(log, error) || fs::file_size(log, error) < 150'000);
         ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    pid_t rank = first;
    if (which == 1) {
      std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", job.process()));
      for (pid_t each = 0; children >> each;) rank = each;
    }
    ::kill(rank, SIGKILL);
    EXPECT_NE(job.stop(0).status, 0) << "a dead rank ends the job";
  }
  const ProgramRun last = run_in_shell(mpirun(2), into("killed"));
  EXPECT_EQ(last.status, 0) << last.errors;
  EXPECT_GT(recorded_in(last), 0u) << last.output;
  EXPECT_EQ(csv("killed"), csv("alone"));
}

TEST_F(StudyCommand, WhatNoRankCanReadIsOneLine) {
  if (!has_mpi()) GTEST_SKIP() << "built without MPI";
  const ProgramRun run =
      run_in_shell(mpirun(3), {"study", path("none.toml"), "--out", path("none")});
  EXPECT_EQ(run.status, 2);
  const std::string line = "none.toml: no such file";
  const std::size_t first = run.errors.find(line);
  ASSERT_NE(first, std::string::npos) << run.errors;
  EXPECT_EQ(run.errors.find(line, first + 1), std::string::npos) << run.errors;
}

TEST_F(StudyCommand, AFullDiskIsOneLineAndLosesNothing) {
  const ProgramRun full = run_in_shell("ulimit -f 24; exec \"$@\"", into("full"));
  EXPECT_EQ(full.status, 1);
  EXPECT_THAT(full.errors, HasSubstr("cannot be written (is there room on the disk?)"));
  EXPECT_EQ(std::count(full.errors.begin(), full.errors.end(), '\n'), 1) << full.errors;
  const ProgramRun again = run_program(into("full"));
  EXPECT_EQ(again.status, 0) << again.errors;
  EXPECT_EQ(again.errors, "");
  static_cast<void>(run_program(into("alone")));
  EXPECT_EQ(csv("full"), csv("alone"));
}

TEST_F(StudyCommand, ByMpirunAChangedStudyIsRefusedInOneLine) {
  if (!has_mpi()) GTEST_SKIP() << "built without MPI";
  static_cast<void>(run_program(into("begun")));
  write(61);
  const ProgramRun run = run_in_shell(mpirun(2), into("begun"));
  EXPECT_EQ(run.status, 2);
  const std::string line = "was begun with another content of study.toml";
  const std::size_t first = run.errors.find(line);
  ASSERT_NE(first, std::string::npos) << run.errors;
  EXPECT_EQ(run.errors.find(line, first + 1), std::string::npos) << run.errors;
}

/// The port in "http://127.0.0.1:PORT".
std::uint16_t port_in(const std::string& output) {
  const std::string before = "http://127.0.0.1:";
  const std::size_t at = output.find(before);
  if (at == std::string::npos) return 0;
  return static_cast<std::uint16_t>(std::stoi(output.substr(at + before.size())));
}

/// What a running study's page says of its progress; null if it says nothing.
nlohmann::json progress_of(RawClient& page) {
  nlohmann::json answer = nlohmann::json::parse(page.get("/progress.json").body, nullptr, false);
  return answer.is_object() ? answer : nlohmann::json();
}

/// Asks until `is_so`, or the page is silent, or for long.
template <typename IsSo>
nlohmann::json progress_when(RawClient& page, const IsSo& is_so) {
  nlohmann::json at = progress_of(page);
  for (int k = 0; k < 4000 && !at.is_null() && !is_so(at); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    at = progress_of(page);
  }
  return at;
}

/// Looks on at the page of a study of 20000 designs until it has gone on.
void expect_page_that_goes_on(RawClient& page) {
  EXPECT_EQ(page.get("/").status, 200);
  const nlohmann::json first =
      progress_when(page, [](const nlohmann::json& at) { return !at["best"].empty(); });
  ASSERT_FALSE(first.is_null());
  EXPECT_EQ(first["state"], "running");
  EXPECT_EQ(first["evaluations"], 20000);
  ASSERT_FALSE(first["best"].empty());
  EXPECT_GT(first["best"][0]["value"], 0.0);
  EXPECT_THAT(page.get("/report.html").body, HasSubstr("Best so far"));
  const nlohmann::json later = progress_when(
      page, [&first](const nlohmann::json& at) { return at["done"] != first["done"]; });
  ASSERT_FALSE(later.is_null());
  EXPECT_GT(later["done"], first["done"]);
}

TEST_F(StudyCommand, HasAPageWhileItRuns) {
  write(20000);
  std::vector<std::string> words = into("seen");
  words.insert(words.end(), {"--port", "0"});
  RunningProgram program(words);
  ASSERT_TRUE(program.says("http://127.0.0.1:", 20.0));
  RawClient page(port_in(program.output()));
  ASSERT_NO_FATAL_FAILURE(expect_page_that_goes_on(page));
  // It is asked to end; who looks on is told.
  ::kill(program.process(), SIGINT);
  const nlohmann::json last =
      progress_when(page, [](const nlohmann::json& at) { return at["state"] != "running"; });
  ASSERT_FALSE(last.is_null());
  EXPECT_EQ(last["state"], "stopped");
  EXPECT_EQ(program.stop(0).status, 1);
}

// The first rank has the page, of what all ranks do; the others ask for no port.
TEST_F(StudyCommand, ByMpirunTheFirstRankHasThePage) {
  if (!has_mpi()) GTEST_SKIP() << "built without MPI";
  write(20000);
  std::vector<std::string> words = into("seen");
  words.insert(words.end(), {"--port", "0"});
  RunningProgram job(words, mpirun(2));
  ASSERT_TRUE(job.says("http://127.0.0.1:", 20.0));
  const std::uint16_t port = port_in(job.output());
  RawClient page(port);
  ASSERT_NO_FATAL_FAILURE(expect_page_that_goes_on(page));
  const std::string said = job.output();
  EXPECT_EQ(said.find("http://"), said.rfind("http://")) << said;
  EXPECT_NE(job.stop(SIGINT).status, 0);
}

TEST_F(StudyCommand, ItsPageIsRefusedBeforeItBegins) {
  std::vector<std::string> words = into("seen");
  words.insert(words.end(), {"--port", "70000"});
  expect_refused(run_program(words), {"--port 70000"});
  EXPECT_FALSE(fs::exists(path("seen")));
}

TEST_F(StudyCommand, RefusesWhatIsWrong) {
  expect_refused(run_program({"study"}), {"give a study file"});
  expect_refused(run_program({"study", path("study.toml")}), {"give --out"});
  expect_refused(run_program({"study", path("none.toml"), "--out", path("x")}),
                 {"none.toml: no such file"});
  for (const char* shard : {"0/3", "4/3", "1", "1/", "a/b", "-1/3", "1/3x"}) {
    std::vector<std::string> words = into("x");
    words.emplace_back(fmt::format("--shard={}", shard));
    expect_refused(run_program(words), {"expected I/N"});
  }
  expect_refused(run_program({"study", "export", path("none"), "--to", path("x.csv")}),
                 {"has no journal.sqlite"});
  EXPECT_FALSE(fs::exists(path("x")));
}

TEST_F(StudyCommand, SaysThatNoDesignIsFeasible) {
  std::ofstream(folder_ / "study.toml", std::ios::app)
      << "[constraints]\nsmall = { formula = \"device.geometry.crank_mm\", at_most = 1 }\n";
  const ProgramRun run = run_program(into("none"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("no design is feasible; the first: "));
  EXPECT_THAT(csv("none"), HasSubstr("above 1"));
}

TEST_F(StudyCommand, WritesContactsThatPythonReads) {
  std::ofstream(folder_ / "contacts.toml") << "finger = \"index\"\n[contacts]\ncontacts_a_press = "
                                              "4\ndepth_mm = { min = 0.3, max = 0.6 }\n"
                                              "[design]\nkind = \"contacts\"\nsize = 40\n";
  const ProgramRun run = run_program({"study", path("contacts.toml"), "--out", path("contacts")});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_THAT(run.output, StartsWith("40 contacts; 0 of 10 presses"));
  const std::string file = path("contacts.h5");
  EXPECT_EQ(run_program({"study", "export", path("contacts"), "--to", file}).status, 0);
  const std::string example = fmt::format(
      "/usr/bin/python3 {}/examples/contacts/load_contacts.py {}", source_folder(), file);
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) GTEST_SKIP() << "no h5py";
  const ProgramRun loaded = run_in_shell(example, {});
  EXPECT_EQ(loaded.status, 0) << loaded.errors;
  EXPECT_THAT(loaded.output, StartsWith("Labelled contacts of a soft finger pad by softfinger"));
  EXPECT_THAT(loaded.output, HasSubstr("contacts, "));
}

// Ctrl-C: what is done is kept, one line says how to go on.
TEST_F(StudyCommand, EndsWhereItIsStopped) {
  RunningProgram program(into("stopped"));
  // It listens to signals before it writes anything.
  for (int k = 0; k < 1000 && !std::filesystem::exists(path("stopped/journal.sqlite")); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const ProgramRun run = program.stop(SIGINT);
  if (run.status == 0) GTEST_SKIP() << "it was through before";
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("are recorded, and the same command goes on from there"));
  EXPECT_EQ(run_program(into("stopped")).status, 0);
}

}  // namespace
}  // namespace softfinger
