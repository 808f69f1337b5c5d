#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "softfinger/loop/device_loop.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/session/rendering_judge.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/session/worn_device.hpp"

namespace softfinger {

/// What the virtual finger of a scene does, as far as a device is told: the same for every device
/// that ticks at this rate.
struct VirtualSide {
  struct Tick {
    std::int64_t step = 0;
    double time = 0.0;    ///< s, end of that step
    bool tracked = true;  ///< the tracker knew where the finger was
    ContactSet contact;
    std::vector<Vector3> nodes_W;  ///< all, m
    Pose X_WF;
  };

  std::shared_ptr<const FingerModel> model;
  double device_rate = 0.0;  ///< Hz
  std::int64_t steps = 0;
  FingerSummary summary;    ///< of the steps alone
  std::vector<Tick> ticks;  ///< in their order

  /// Of memory, about.
  [[nodiscard]] std::size_t bytes() const;
};

/// Runs a scene of one finger, as fast as possible and to the end of its script, with no device.
/// `model` stands instead of what the scene names. device_rate in Hz. Throws InputError where the
/// scene has another number of fingers, or its tracker does not end.
[[nodiscard]] VirtualSide run_virtual_side(const Scene& scene,
                                           const std::shared_ptr<const FingerModel>& model,
                                           double device_rate);

/// What a device is judged with.
struct JudgedDevice {
  WornDevice worn;
  std::filesystem::path file;                 ///< for messages
  std::shared_ptr<const FingerModel> wearer;  ///< null: the virtual side's finger
  const ObjectiveKind* objective = nullptr;   ///< null: the device file's
  JudgedSides sides;
};

/// As evaluate() of the scene with this device, of whose virtual side `side` is. Of the run it
/// tells what repeats: no processor times. Throws as evaluate() does.
[[nodiscard]] Evaluation judge_on(const VirtualSide& side, const JudgedDevice& device);

}  // namespace softfinger
