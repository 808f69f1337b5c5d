#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "softfinger/geometry/mesh_shape.hpp"

namespace softfinger {

struct ReplayOptions {
  std::filesystem::path recording;
  /// Run this scene with the recorded input; empty: the scene, fingers and devices as recorded.
  std::optional<std::filesystem::path> scene;
  /// Person file instead of the recorded one.
  std::optional<std::filesystem::path> person = {};
  LoadObserver load_observer;
};

struct ReplayResult {
  bool agree = true;
  std::int64_t steps = 0;                        ///< of the recording
  std::optional<std::int64_t> first_difference;  ///< step
  std::string difference;  ///< what differs there, for people; empty where all agrees
  std::string cut;         ///< a line for people where the recording was cut, else empty
};

/// Runs a recording again with its recorded tracked poses and device ticks and compares every step
/// bit by bit. Uses the active instruction set; no device is opened. Stops at the first difference.
/// `progress` gets the fraction done, and what it throws ends it. Throws InputError for what is no
/// recording, is damaged, or has other fingers than the scene.
[[nodiscard]] ReplayResult replay(const ReplayOptions& options,
                                  const std::function<void(double)>& progress = {});

/// The instruction set a recording was made with. Throws InputError.
[[nodiscard]] std::string recorded_instruction_set(const std::filesystem::path& recording);

}  // namespace softfinger
