#include "softfinger/session/scene_load.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace softfinger {
namespace {

constexpr auto kLookInterval = std::chrono::milliseconds(2);

}  // namespace

SceneLoad::SceneLoad(const SetupOptions& options) : observer_(options.load_observer) {
  SetupOptions here = options;
  here.load_observer.progress = [this](double fraction) { progress_.store(fraction); };
  here.load_observer.message = [this](const std::string& line) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(line);
  };
  here.load_observer.stop = stop_.get_token();
  setup_ = std::async(std::launch::async, [here = std::move(here)] { return load_setup(here); });
}

SceneLoad::~SceneLoad() {
  give_up();
  if (setup_.valid()) setup_.wait();
}

bool SceneLoad::done() {
  // What was said before the end is told before it.
  const bool ended = setup_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  tell();
  return ended;
}

void SceneLoad::tell() {
  const double progress = progress_.load();
  if (observer_.progress && progress != told_progress_) observer_.progress(progress);
  told_progress_ = progress;
  std::deque<std::string> lines;
  {
    const std::lock_guard lock(mutex_);
    lines.swap(messages_);
  }
  for (const std::string& line : lines) {
    if (observer_.message) observer_.message(line);
  }
}

std::shared_ptr<const RunSetup> load_unless_stopped(const SetupOptions& options,
                                                    const std::atomic<bool>& stop) {
  SceneLoad load(options);
  while (!load.done()) {
    if (stop.load()) return nullptr;
    std::this_thread::sleep_for(kLookInterval);
  }
  return stop.load() ? nullptr : load.take();
}

}  // namespace softfinger
