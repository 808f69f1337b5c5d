// A recording away from where it was made: copied while it is written, and where nobody may write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Recorded : public testing::Test {
 protected:
  void record() const {
    const ProgramRun run =
        run_program({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "0.3",
                     "--as-fast-as-possible", "--record", file});
    ASSERT_EQ(run.status, 0) << run.errors;
  }
  /// As older versions and runs that were killed leave it: with a write-ahead log that is empty.
  void put_into_log_mode() const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, "pragma journal_mode = wal", nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(database);
  }
  /// A folder in its place lets nobody, not even root, make the file that reading a log needs.
  static void forbid_log(const std::string& recording) { fs::create_directory(recording + "-shm"); }

  const Workplace place;
  const std::string file = place.path("run #1%?.sqlite");
};

TEST_F(Recorded, IsOneFileThatIsReadWhereNothingCanBeWritten) {
  record();
  EXPECT_FALSE(fs::exists(file + "-wal"));
  forbid_log(file);
  const ProgramRun replay = run_program({"replay", file});
  EXPECT_EQ(replay.status, 0) << replay.errors;
}

TEST_F(Recorded, WithALogThatHasEndedIsReadThereToo) {
  record();
  put_into_log_mode();
  forbid_log(file);
  const ProgramRun replay = run_program({"replay", file});
  EXPECT_EQ(replay.status, 0) << replay.errors;
  EXPECT_EQ(run_program({"export", file, "--to", place.path("csv")}).status, 0);
}

TEST_F(Recorded, CopiedWhileItIsWrittenNeedsItsLog) {
  RunningProgram program({"run", place.path("scenes/plane.toml"), "--headless", "--record", file});
  for (int i = 0; i < 2000 && (!fs::exists(file + "-wal") || fs::file_size(file + "-wal") < 100000);
       ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::string alone = place.path("alone.sqlite");
  const std::string whole = place.path("whole.sqlite");
  fs::copy(file, alone);
  fs::copy(file, whole);
  fs::copy(file + "-wal", whole + "-wal");
  EXPECT_EQ(program.stop(SIGINT).status, 0);
  for (const std::string command : {"replay", "export", "condition", "emulate"}) {
    std::vector<std::string> words{command, alone};
    if (command == "export") words.insert(words.end(), {"--to", place.path("csv")});
    if (command == "condition") words.emplace_back("--filter");
    if (command == "emulate") words = {"emulate", "udp", alone, "--port", "9"};
    const ProgramRun run = run_program(words);
    expect_refused(run, {"was being written when it was copied"});
    EXPECT_THAT(run.errors, HasSubstr("alone.sqlite-wal, which belongs to it"));
  }
  // What there is agrees, but it is not all, and that is told.
  const ProgramRun cut = run_program({"replay", whole, "--json"});
  EXPECT_EQ(cut.status, 0);
  EXPECT_THAT(cut.output, HasSubstr("\"complete\": false"));
  EXPECT_THAT(cut.errors, HasSubstr("whole.sqlite: ends at step "));
  EXPECT_THAT(run_program({"export", whole, "--to", place.path("cut")}).errors,
              HasSubstr("whole.sqlite: ends at step "));
  // With its log, but where it cannot be read.
  forbid_log(place.path("there.sqlite"));
  fs::copy(file, place.path("ended.sqlite"));
  fs::copy(alone, place.path("there.sqlite"));
  fs::copy(whole, place.path("there.sqlite-wal"));
  expect_refused(run_program({"replay", place.path("there.sqlite")}),
                 {"a folder that can be written"});
  // Ended, it is one file.
  const ProgramRun ended = run_program({"replay", place.path("ended.sqlite"), "--json"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.errors, "");
  EXPECT_THAT(ended.output, HasSubstr("\"complete\": true"));
}

}  // namespace
}  // namespace softfinger
