#pragma once

#include <Eigen/Core>
#include <memory>

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// How a press on a device that yields ended.
struct YieldingSummary {
  TwinSummary twin;
  bool balanced = true;    ///< skin and motors hold each other, to the tolerance
  double torque = 0.0;     ///< the greatest of a motor, N m, or N
  bool gives_way = false;  ///< some motor cannot hold what the skin presses it with
};

/// A twin on a device whose motors yield as its file's `[statics]` say: the skin presses the
/// mechanism back until they hold it, or they give way. Quasi-static; friction in the gears and the
/// mechanism's own weight are left out. For judging, not for loops: allocates.
class YieldingTwin {
 public:
  /// `device` has statics.
  YieldingTwin(std::shared_ptr<const FingerModel> wearer, std::shared_ptr<const Device> device);

  /// Motors are sent to q, where the linkage closes, `elapsed` s after the last press; see
  /// Twin::press().
  YieldingSummary press(const Configuration& q, double friction_coefficient, double elapsed);
  /// Its configuration() is where the device gave to.
  [[nodiscard]] Twin& twin() { return twin_; }

 private:
  /// How far skin and motors are from holding each other at the twin's configuration, and how that
  /// changes with q; N m by rad or N by m.
  struct Balance {
    Eigen::VectorXd rest;
    Eigen::MatrixXd stiffness;
    double size = 0.0;  ///< of the rest, N
    double load = 0.0;  ///< of the skin, N
    double torque = 0.0;
    bool gives_way = false;
  };
  [[nodiscard]] Balance balance(const JointAngles& sent);
  [[nodiscard]] Eigen::MatrixXd joints_by_q(const Configuration& q,
                                            const JointAngles& joints) const;
  /// Towards the balance, no further than the skin is well behaved.
  [[nodiscard]] Configuration step(const Balance& at) const;
  /// As much of the step as leads to less; the twin is there then.
  [[nodiscard]] Balance search(const Configuration& step, const Balance& at,
                               const JointAngles& sent, TwinSummary& summary);
  [[nodiscard]] double size(const Eigen::VectorXd& load) const;

  Twin twin_;
  Configuration yielded_;  ///< from where it was sent, at the last press
};

}  // namespace softfinger
