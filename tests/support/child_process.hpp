#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace softfinger {

/// A process that `parent` has started; 0: none within half a minute.
inline pid_t child_of(pid_t parent) {
  for (int i = 0; i < 30'000; ++i) {
    std::error_code error;
    const std::filesystem::path tasks = "/proc/" + std::to_string(parent) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks, error)) {
      pid_t child = 0;
      if (std::ifstream(task.path() / "children") >> child) return child;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return 0;
}

}  // namespace softfinger
