// The process that imports a mesh: it ends in time, with its parent, and holds nothing open.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include "../support/child_process.hpp"
#include "../support/large_mesh.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mesh_file.hpp"
#include "softfinger/geometry/mesh_import.hpp"

namespace softfinger {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

MeshFiles large_mesh() { return {{"large.obj", text_of_large_mesh()}}; }

bool within_ten_seconds(const std::function<bool()>& condition) {
  for (int i = 0; i < 1000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

std::string refusal_of(const MeshFiles& files, const ImportLimits& limits) {
  try {
    static_cast<void>(import_mesh_apart(MeshFormat::kObj, files.begin()->first, files, limits));
  } catch (const MeshRefusal& refusal) {
    return refusal.message;
  }
  return "imported";
}

TEST(MeshImportApart, AProcessThatHangsIsEndedAfterItsTime) {
  const MeshFiles files = large_mesh();
  auto refusal = std::async(std::launch::async,
                            [&] { return refusal_of(files, {.longest = 3s, .stop = {}}); });
  const pid_t child = child_of(::getpid());
  ASSERT_GT(child, 0);
  ASSERT_EQ(::kill(child, SIGSTOP), 0);  // takes no processor time from now on
  ASSERT_EQ(refusal.wait_for(60s), std::future_status::ready);
  EXPECT_EQ(refusal.get(), "could not be read within 3 s");
  EXPECT_EQ(::kill(child, 0), -1);
}

TEST(MeshImportApart, AnEndThatIsAskedForComesAtOnce) {
  const MeshFiles files = large_mesh();
  std::stop_source source;
  auto refusal = std::async(std::launch::async, [&] {
    return refusal_of(files, {.longest = {}, .stop = source.get_token()});
  });
  const pid_t child = child_of(::getpid());
  ASSERT_GT(child, 0);
  ASSERT_EQ(::kill(child, SIGSTOP), 0);
  source.request_stop();
  ASSERT_EQ(refusal.wait_for(10s), std::future_status::ready);
  EXPECT_EQ(refusal.get(), "is no longer wanted");
  EXPECT_EQ(::kill(child, 0), -1);
}

TEST(MeshImportApart, HasNothingOfTheProgramOpen) {
  const MeshFiles files = large_mesh();
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  std::stop_source source;
  auto refusal = std::async(std::launch::async, [&] {
    return refusal_of(files, {.longest = {}, .stop = source.get_token()});
  });
  const pid_t child = child_of(::getpid());
  ASSERT_GT(child, 0);
  const auto open_files = [&] {
    std::error_code error;
    const fs::directory_iterator folder("/proc/" + std::to_string(child) + "/fd", error);
    return std::distance(begin(folder), end(folder));
  };
  EXPECT_TRUE(within_ten_seconds([&] { return open_files() == 1; })) << open_files();
  // The far end sees that this program's end is closed.
  ::close(ends[1]);
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0);
  ::close(ends[0]);
  source.request_stop();
  EXPECT_EQ(refusal.get(), "is no longer wanted");
}

TEST(MeshImportApart, EndsWithTheProgram) {
  const MeshFiles files = large_mesh();
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // so that what is left comes to this process
  const pid_t program = ::fork();
  ASSERT_GE(program, 0);
  if (program == 0) {
    static_cast<void>(refusal_of(files, {}));
    ::_exit(0);
  }
  const pid_t child = child_of(program);
  ASSERT_GT(child, 0);
  std::this_thread::sleep_for(100ms);  // it has asked to be ended by now
  ::kill(child, SIGSTOP);
  ::kill(program, SIGKILL);
  ASSERT_EQ(::waitpid(program, nullptr, 0), program);
  int status = 0;
  EXPECT_TRUE(within_ten_seconds([&] { return ::waitpid(child, &status, WNOHANG) == child; }));
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST(MeshImportApart, APipeIsNoMesh) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "pipe.obj";
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  try {
    static_cast<void>(read_mesh_source(file));
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), file.string() + ": is a pipe, expected a file");
  }
}

}  // namespace
}  // namespace softfinger
