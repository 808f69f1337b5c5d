#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/session/live_session.hpp"
#include "softfinger/twin/rendering_measures.hpp"

namespace softfinger {

struct EvaluationOptions {
  RunOptions run;  ///< headless and as fast as possible whatever it says; devices are emulated
};

/// One device tick of one finger, judged.
struct EvaluatedFrame {
  std::size_t finger = 0;
  double time = 0.0;               ///< s
  double virtual_force = 0.0;      ///< normal force of the virtual contact, N
  double virtual_force_sum = 0.0;  ///< sum of the magnitudes of its normal forces, N
  double twin_force = 0.0;         ///< of the twin, N
  double twin_force_sum = 0.0;     ///< N
  Vector3 virtual_tangential_F = Vector3::Zero();  ///< sum of the virtual tangential forces, N
  Vector3 twin_tangential_F = Vector3::Zero();     ///< of the twin's, N
  RenderingMeasures commanded;                     ///< twin pressed by the commanded configuration
  /// Twin pressed where the servos are at this time; empty for a device without servos.
  std::optional<RenderingMeasures> lagged;
};

struct Evaluation {
  std::vector<EvaluatedFrame> frames;
  MeasureMeans commanded, lagged;
  bool has_lagged = false;           ///< every device has servos
  std::uint64_t unconverged = 0;     ///< presses of the twin that did not come to rest
  std::vector<std::string> fingers;  ///< names, in the order of EvaluatedFrame::finger
  RunSummary run;
};

/// Runs a scene with emulated devices and presses a second finger, the twin, with each command:
/// what the wearer would feel, against what the virtual finger touches at the step whose match
/// produced the command. Throws InputError where a finger has no device, or the wearer's skin does
/// not cover what is touched; OperationError where `stop` becomes true while the scene loads.
[[nodiscard]] Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                                  const RunObserver& observer = {});

}  // namespace softfinger
