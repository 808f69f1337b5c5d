#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "../support/lever_platform.hpp"
#include "simulated_line.hpp"

namespace softfinger {

/// A loop that wants a lever platform to press, over a simulated line. What it is plugged into is
/// the test's own.
class LeverLine : public testing::Test {
 protected:
  explicit LeverLine(const LeverShape& shape) : device_(lever_platform(shape)), line_(device_) {
    line_.wanted = [this](double) { return pressing_; };
  }
  [[nodiscard]] JointAngles joints_at(const Configuration& q) const {
    JointAngles joints;
    EXPECT_TRUE(device_->inverse_kinematics(q, joints));
    return joints;
  }
  [[nodiscard]] double away(Eigen::Index joint, const Configuration& q) const {
    return std::abs(line_.standing()[joint] - joints_at(q)[joint]);
  }
  [[nodiscard]] double away(const Configuration& q) const {
    return (line_.standing() - joints_at(q)).cwiseAbs().maxCoeff();
  }
  /// No command goes further than a joint may in the time since the one before it.
  void expect_no_jump() const {
    const auto& sent = line_.sent();
    ASSERT_GT(sent.size(), 10u);
    const ServoSettings& servo = device_->settings().transport->servos.front();
    const double rounding = 2.0 * servo.step / std::abs(servo.per_radian) + 1e-9;
    for (std::size_t k = 1; k < sent.size(); ++k) {
      const double most =
          device_->joint_limits().max_rate * (sent[k].time - sent[k - 1].time) + rounding;
      EXPECT_LE((sent[k].joints - sent[k - 1].joints).cwiseAbs().maxCoeff(), most) << sent[k].time;
    }
  }

  std::shared_ptr<const Device> device_;
  Configuration pressing_ = [] {
    Configuration q(3);
    q << 4.0 * deg, 0.0, 3.0 * mm;
    return q;
  }();
  SimulatedLine line_;
  int looks_ = 0;
};

}  // namespace softfinger
