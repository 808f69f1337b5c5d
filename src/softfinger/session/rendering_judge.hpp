#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "softfinger/loop/device_loop.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/twin/skin_comparison.hpp"
#include "softfinger/twin/twin.hpp"
#include "softfinger/twin/yielding_twin.hpp"

namespace softfinger {

/// Presses a second finger, the twin, with each command of one finger's device, and compares what
/// it feels with the virtual contact.
class RenderingJudge {
 public:
  /// `wearer`: who has the device on, `device` as it sits there; may be the model itself.
  RenderingJudge(std::shared_ptr<const FingerModel> model,
                 std::shared_ptr<const FingerModel> wearer,
                 const std::shared_ptr<const Device>& device, const JudgedSides& sides = {});

  /// The device's last tick, which was about this virtual finger; adds a frame to `answer`.
  void judge(const VirtualFinger& finger, const DeviceLoop& device, Evaluation& answer);

  /// Throws InputError where the virtual contact was where the wearer has no skin.
  void check_cover() const;

 private:
  RenderingMeasures press(Twin& twin, const Configuration& q, double friction, double elapsed,
                          Evaluation& answer);
  void judge_loaded(const Configuration& q, double friction, double elapsed, EvaluatedFrame& frame,
                    Evaluation& answer);
  void notice_bare(double time);

  std::shared_ptr<const FingerModel> model_, wearer_;
  SkinComparison comparison_;
  Twin twin_;
  std::optional<Twin> lagged_;
  std::optional<YieldingTwin> loaded_;
  std::vector<Vector3> nodes_F_;
  Configuration servo_q_;
  double time_ = 0.0;
  struct {
    double time = 0.0;  ///< s
    SkinComparison::Cover cover;
  } worst_;  ///< of the frames with too much contact off the wearer's skin
};

}  // namespace softfinger
