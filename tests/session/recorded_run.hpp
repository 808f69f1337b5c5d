#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {

namespace fs = std::filesystem;

/// A headless run of a scene that is written to `file`; `duration` in s.
inline RunSummary record(const std::filesystem::path& scene, const std::filesystem::path& file,
                         double duration, std::vector<std::string> trackers = {}, int threads = 1) {
  RunOptions options;
  options.scene = scene;
  options.threads = threads;
  options.trackers = std::move(trackers);
  options.duration = duration;
  options.as_fast_as_possible = true;
  options.recording = file;
  const std::atomic<bool> stop{false};
  return run_headless(options, stop);
}

/// All ticks of a recording.
inline std::vector<TickRecord> ticks_of(const std::filesystem::path& file) {
  RecordingReader reader(file);
  std::vector<TickRecord> ticks;
  TickRecord tick;
  while (reader.next(tick)) ticks.push_back(tick);
  return ticks;
}

/// How many steps both recordings have, all alike.
inline int steps_alike(const std::filesystem::path& one, const std::filesystem::path& other) {
  RecordingReader a(one);
  RecordingReader b(other);
  StepRecord step_a, step_b;
  int rows = 0;
  while (a.next(step_a)) {
    EXPECT_TRUE(b.next(step_b));
    const char* difference = first_difference(step_a, step_b);
    EXPECT_EQ(difference, nullptr) << "step " << step_a.step;
    if (difference != nullptr) break;
    ++rows;
  }
  return rows;
}

}  // namespace softfinger
