#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace softfinger {

/// Visitors of the page that come and go as fast as they can, some of them slow, silent or hostile,
/// and up to two hundred at a time.
class Visitors {
 public:
  explicit Visitors(std::uint16_t port);
  ~Visitors();
  Visitors(const Visitors&) = delete;
  Visitors& operator=(const Visitors&) = delete;
  [[nodiscard]] long came() const { return came_; }

 private:
  void keep_coming(int kind);

  std::uint16_t port_;
  std::atomic<long> came_{0};
  std::atomic<bool> ending_{false};
  std::vector<std::thread> threads_;
};

/// A page that watches all the time.
class Watcher {
 public:
  explicit Watcher(std::uint16_t port) : thread_([this, port] { watch(port); }) {}
  /// Waits until the server ends, or does not serve it for 10 s.
  void join() { thread_.join(); }
  [[nodiscard]] long pictures() const { return pictures_; }
  [[nodiscard]] double longest_gap() const { return longest_gap_; }  ///< s between two

 private:
  void watch(std::uint16_t port);

  std::atomic<long> pictures_{0};
  std::atomic<double> longest_gap_{0.0};
  std::thread thread_;
};

}  // namespace softfinger
