#pragma once

#include <optional>
#include <vector>

#include "softfinger/device/configuration.hpp"

namespace softfinger {

/// How long ago servos were told to be where they are: told joint angles are kept for a while, and
/// the joint that moved furthest one way is looked up among them. A servo without any lag of its
/// own shows one tick of the device, since it has a tick to get to where it is told.
class ServoLag {
 public:
  /// `least_motion`: of a joint before it says something of lag; rad, or m for linear joints.
  ServoLag(Eigen::Index joints, double least_motion);

  /// The servos are told to go there. `time` in s, increasing.
  void sent(double time, const JointAngles& joints);
  /// The servos were there at `time`: s since they were told to, between the two times told that
  /// lie around it. Empty where no joint keeps moving one way, where the furthest one is not on its
  /// way, and where it is further behind than is kept.
  [[nodiscard]] std::optional<double> seen(double time, const JointAngles& joints) const;
  /// What was told counts no more.
  void reset() { count_ = 0; }

 private:
  static constexpr std::size_t kKept = 256;

  struct Told {
    double time = 0.0;
    JointAngles joints;
  };
  /// `age` entries before the newest.
  [[nodiscard]] const Told& told(std::size_t age) const {
    return told_[(next_ + kKept - 1 - age) % kKept];
  }
  /// How many entries before the newest the joint has moved one way up to it.
  [[nodiscard]] std::size_t one_way(Eigen::Index joint) const;

  double least_motion_;
  std::vector<Told> told_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace softfinger
