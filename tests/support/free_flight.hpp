#pragma once

#include <memory>
#include <vector>

#include "box_finger.hpp"
#include "softfinger/finger/finger_potential.hpp"

namespace softfinger::testing_support {

/// A disturbed finger without coupling and without objects: momentum is kept, energy never grows.
class FreeFlight {
 public:
  explicit FreeFlight(double time_step) : time_step_(time_step) {
    model_->coupling = {0.0, 0.0, 0.0, 0.0};
    potential_ = std::make_unique<FingerPotential>(*model_, FingerPotential::Bone::kCoupled, 0,
                                                   FingerPotential::Options{});
    masses_.assign(potential_->elastic().masses().begin(), potential_->elastic().masses().end());
    inertia_ = bone_inertia(*model_, masses_);
    positions_ = model_->mesh.nodes;
    displace(positions_, 0.3e-3, 3);
    velocities_.assign(positions_.size(), Vector3(0.2, -0.1, 0.05));
    displace(velocities_, 0.1, 4);
    bone_.velocity = Vector3(0.2, -0.1, 0.05);
    bone_.rotation_rate = skew(Vector3(3, -2, 1));
  }

  /// False if the step did not converge.
  bool step() {
    FingerPotential::Step step;
    step.time_step = time_step_;
    step.old_positions = positions_;
    step.velocities = velocities_;
    step.old_bone = bone_;
    potential_->begin(step);
    potential_->start_from_prediction();
    NewtonOptions options;
    options.tolerance = 1e-9;
    const NewtonSummary summary = minimise(*potential_, options);
    for (std::size_t n = 0; n < positions_.size(); ++n) {
      velocities_[n] = (potential_->positions()[n] - positions_[n]) / time_step_;
      positions_[n] = potential_->positions()[n];
    }
    const Pose& X_WF = potential_->bone_pose();
    bone_.velocity = (X_WF.translation - bone_.X_WF.translation) / time_step_;
    bone_.rotation_rate = (X_WF.rotation - bone_.X_WF.rotation) / time_step_;
    bone_.X_WF = X_WF;
    return summary.converged;
  }

  [[nodiscard]] Vector3 momentum() const {
    Vector3 p = inertia_.mass * bone_.velocity + bone_.rotation_rate * inertia_.first;
    for_each_free([&](std::size_t n) { p += masses_[n] * velocities_[n]; });
    return p;
  }

  [[nodiscard]] double energy() const {
    double e =
        potential_->elastic_energy() + 0.5 * inertia_.mass * bone_.velocity.squaredNorm() +
        bone_.velocity.dot(bone_.rotation_rate * inertia_.first) +
        0.5 * (bone_.rotation_rate * inertia_.second).cwiseProduct(bone_.rotation_rate).sum();
    for_each_free([&](std::size_t n) { e += 0.5 * masses_[n] * velocities_[n].squaredNorm(); });
    return e;
  }

 private:
  template <typename Visit>
  void for_each_free(Visit&& visit) const {
    for (std::size_t n = 0; n < positions_.size(); ++n) {
      if (!model_->node_is_rigid[n]) visit(n);
    }
  }

  double time_step_;
  std::shared_ptr<FingerModel> model_ = box_finger();
  std::unique_ptr<FingerPotential> potential_;
  std::vector<double> masses_;
  BoneInertia inertia_;
  std::vector<Vector3> positions_, velocities_;
  BoneState bone_;
};

}  // namespace softfinger::testing_support
