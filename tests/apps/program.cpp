#include "program.hpp"
#include "../support/folders.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

namespace softfinger {

namespace {

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments,
                               const std::string& shell_line) {
  static std::atomic<int> count{0};
  const std::string stem =
      testing::TempDir() + "softfinger-" + std::to_string(getpid()) + "-" + std::to_string(count++);
  output_file_ = stem + ".out";
  errors_file_ = stem + ".err";
  std::vector<std::string> words;
  if (!shell_line.empty()) words = {"/bin/bash", "-c", shell_line, "bash"};
  words.emplace_back(build_folder() + "/softfinger");
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, output_file_.c_str(), kNew, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, errors_file_.c_str(), kNew, 0600);
  // Under nohup too the program is to notice a terminal that hangs up.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t noticed;
  sigemptyset(&noticed);
  sigaddset(&noticed, SIGHUP);
  posix_spawnattr_setsigdefault(&attributes, &noticed);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  if (posix_spawn(&process_, argv.front(), &actions, &attributes, argv.data(), environ) != 0) {
    ADD_FAILURE() << "cannot start " << argv.front();
    reaped_ = true;
  }
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
}

RunningProgram::~RunningProgram() {
  if (!reaped_) (void)stop(SIGKILL);
  std::error_code ignored;
  std::filesystem::remove(output_file_, ignored);
  std::filesystem::remove(errors_file_, ignored);
}

bool RunningProgram::ended() {
  if (!reaped_) reaped_ = waitpid(process_, &wait_status_, WNOHANG) == process_;
  return reaped_;
}

bool RunningProgram::says(const std::string& text, double seconds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < deadline) {
    const bool last_look = ended();
    if (content(output_file_).find(text) != std::string::npos ||
        content(errors_file_).find(text) != std::string::npos) {
      return true;
    }
    if (last_look) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

std::string RunningProgram::output() const { return content(output_file_); }

ProgramRun RunningProgram::stop(int signal) {
  if (!reaped_) {
    if (signal != 0) kill(process_, signal);
    waitpid(process_, &wait_status_, 0);
    reaped_ = true;
  }
  const int status =
      WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_);
  return {status, content(output_file_), content(errors_file_)};
}

void expect_refused(const ProgramRun& run, const std::vector<std::string>& words) {
  EXPECT_EQ(run.status, 2) << run.errors;
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(std::ranges::count(run.errors, '\n'), 1) << run.errors;
  for (const std::string& word : words) EXPECT_THAT(run.errors, testing::HasSubstr(word));
}

ProgramRun run_program(const std::vector<std::string>& arguments) {
  return RunningProgram(arguments).stop(0);
}

ProgramRun run_in_shell(const std::string& line, const std::vector<std::string>& arguments) {
  return RunningProgram(arguments, line).stop(0);
}

}  // namespace softfinger
