#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/session/live_session.hpp"
#include "softfinger/twin/rendering_measures.hpp"
#include "softfinger/twin/skin_comparison.hpp"

namespace softfinger {

/// What is looked at besides the skin under the commanded configuration; each costs time.
struct JudgedSides {
  bool lagged = true;  ///< where the servos are, as far as the device has any
  bool loaded = true;  ///< where the motors hold it, as far as its file tells their statics
  SkinComparison::Depth depth = SkinComparison::Depth::kTissue;
};

struct EvaluationOptions {
  RunOptions run;  ///< headless and as fast as possible whatever it says; devices are emulated
  JudgedSides sides;
};

/// One device tick of one finger, judged.
struct EvaluatedFrame {
  std::size_t finger = 0;
  double time = 0.0;               ///< s
  double virtual_force = 0.0;      ///< normal force of the virtual contact, N
  double virtual_force_sum = 0.0;  ///< sum of the magnitudes of its normal forces, N
  double twin_force = 0.0;         ///< of the twin, N
  double twin_force_sum = 0.0;     ///< N
  double virtual_area = 0.0;       ///< of contact, deformed, m^2
  double twin_area = 0.0;          ///< m^2
  Vector3 virtual_tangential_F = Vector3::Zero();  ///< sum of the virtual tangential forces, N
  Vector3 twin_tangential_F = Vector3::Zero();     ///< of the twin's, N
  RenderingMeasures commanded;                     ///< twin pressed by the commanded configuration
  /// Twin pressed where the servos are at this time; empty for a device without servos.
  std::optional<RenderingMeasures> lagged;
  /// Twin pressed where the motors, sent to the command, hold it; empty for a device whose file
  /// says nothing of their statics.
  std::optional<RenderingMeasures> loaded;
  double motor_torque = 0.0;     ///< the greatest there, N m, or N of linear motors
  bool motors_give_way = false;  ///< they cannot hold the command
};

struct Evaluation {
  std::vector<EvaluatedFrame> frames;
  MeasureMeans commanded, lagged, loaded;
  bool has_lagged = false;           ///< every device has servos
  bool has_loaded = false;           ///< every device's file tells the statics of its motors
  std::vector<bool> linear_motors;   ///< of each finger's device
  std::uint64_t not_held = 0;        ///< frames whose command the motors cannot hold
  std::uint64_t unconverged = 0;     ///< presses of the twin that did not come to rest
  std::vector<std::string> fingers;  ///< names, in the order of EvaluatedFrame::finger
  RunSummary run;
};

/// How the area of contact grew with the force (m^2/N, see AreaSpread) while both touched; NaN: the
/// force hardly varied.
struct AreaSpreadRates {
  double virtual_side = 0.0, twin = 0.0;
};
[[nodiscard]] AreaSpreadRates area_spread_rates(const Evaluation& evaluation, std::size_t finger);

/// Runs a scene with emulated devices and presses a second finger, the twin, with each command:
/// what the wearer would feel, against what the virtual finger touches at the step whose match
/// produced the command. Throws InputError where a finger has no device, or the wearer's skin does
/// not cover what is touched; OperationError where `stop` becomes true while the scene loads.
[[nodiscard]] Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                                  const RunObserver& observer = {});

}  // namespace softfinger
