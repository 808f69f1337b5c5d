#pragma once

#include "softfinger/device/device.hpp"

namespace softfinger {

/// q of joint angles that are a rounding error away from those of `near`: two chord steps on
/// inverse kinematics. Forward kinematics proper searches the workspace, which takes long where it
/// fails. False where the linkage does not close around there, or is singular.
[[nodiscard]] bool nearby_pose(const Device& device, const JointAngles& joints,
                               const Configuration& near, Configuration& q);

}  // namespace softfinger
