#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

#include "softfinger/geometry/mesh_shape.hpp"

/// A bar on stderr for work that takes longer than a second; nothing unless stderr is a terminal.
class ProgressBar {
 public:
  ~ProgressBar() { clear(); }

  /// fraction in [0, 1]; `words` after it.
  void show(double fraction, const std::string& words = {}) {
    using std::chrono::steady_clock;
    const auto now = steady_clock::now();
    if (!terminal_ || now - start_ < std::chrono::seconds(1) ||
        now - drawn_ < std::chrono::milliseconds(100)) {
      return;
    }
    drawn_ = now;
    const auto filled =
        static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(kWidth));
    const std::string line = fmt::format(
        "[{}{}] {:3.0f} %{}{}", std::string(filled, '='), std::string(kWidth - filled, ' '),
        100.0 * std::clamp(fraction, 0.0, 1.0), words.empty() ? "" : " ", words);
    fmt::print(stderr, "\r{}", line);
    std::fflush(stderr);
    shown_ = std::max(shown_, line.size());
  }
  /// Takes the bar away, e.g. before a line is printed.
  void clear() {
    if (shown_ > 0) fmt::print(stderr, "\r{}\r", std::string(shown_, ' '));
    shown_ = 0;
  }

 private:
  static constexpr std::size_t kWidth = 50;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::size_t shown_ = 0;  ///< characters
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point drawn_{};
};

/// Shows on `bar`, which must outlive it, how far the loading of meshes is.
inline softfinger::LoadObserver load_observer(ProgressBar& bar) {
  return {.progress =
              [&bar](double fraction) {
                if (fraction < 1.0) {
                  bar.show(fraction);
                } else {
                  bar.clear();
                }
              },
          .message =
              [&bar](const std::string& message) {
                bar.clear();
                fmt::print(stderr, "softfinger: {}\n", message);
              }};
}
