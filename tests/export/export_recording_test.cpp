#include "softfinger/export/export_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// While it lives no file of this process can be longer.
class Quota {
 public:
  explicit Quota(rlim_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~Quota() {
    setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }
  Quota(const Quota&) = delete;
  Quota& operator=(const Quota&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

class Exporting : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new TemporaryDirectory;
    const ScenesWithoutForceLimit scenes;
    RunOptions options;
    options.scene = scenes.scene("sphere");
    options.duration = 0.2;
    options.as_fast_as_possible = true;
    options.recording = recording();
    options.record_state = true;
    const std::atomic<bool> stop{false};
    run_headless(options, stop);
  }
  static void TearDownTestSuite() { delete directory_; }

  static fs::path recording() { return *directory_ / "run.sqlite"; }
  static fs::path exported(const std::string& name) {
    const fs::path file = recording().parent_path() / name;
    EXPECT_EQ(export_recording(recording(), file), "");
    return file;
  }

  static TemporaryDirectory* directory_;
};
TemporaryDirectory* Exporting::directory_ = nullptr;

TEST_F(Exporting, TheSameRecordingGivesTheSameBytes) {
  for (const std::string ending : {".h5", ".mcap"}) {
    const std::string first = content(exported("first" + ending));
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a clock of seconds shows
    EXPECT_GT(first.size(), 100'000U);
    EXPECT_TRUE(first == content(exported("second" + ending))) << ending;
  }
}

TEST_F(Exporting, TwoAtOnceAreAsGoodAsOne) {
  std::thread other([] { exported("other.h5"); });
  const fs::path file = exported("own.h5");
  other.join();
  EXPECT_TRUE(content(file) == content(*directory_ / "other.h5"));
}

TEST_F(Exporting, ADiskThatIsFullAnywhereLeavesNothingAndSpoilsNoLaterExport) {
  for (const char* name : {"full.h5", "full.mcap"}) {
    const fs::path file = recording().parent_path() / name;
    for (const rlim_t bytes : {1U, 3'000U, 50'000U, 200'000U, 400'000U}) {
      const Quota quota(bytes);
      EXPECT_THROW(static_cast<void>(export_recording(recording(), file)), OperationError)
          << name << " of " << bytes;
    }
    for (const auto& entry : fs::directory_iterator(recording().parent_path())) {
      EXPECT_FALSE(entry.path().filename().string().starts_with(name)) << entry.path();
    }
    EXPECT_GT(fs::file_size(exported(name)), 400'000U);
  }
}

}  // namespace
}  // namespace softfinger
