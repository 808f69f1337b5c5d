#pragma once

#include <algorithm>
#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"
#include "turn_onto.hpp"

namespace softfinger {

/// A finger like the model in this posture on a table at z = `height`, X_WFt.
inline Pose lying(const FingerModel& model, Posture posture, double height) {
  const Matrix3 rotation = turn_onto(up_in_finger(posture), Vector3::UnitZ());
  double lowest = 1.0;
  for (const int node : model.sample_nodes) {
    lowest = std::min(lowest, (rotation * model.mesh.nodes[static_cast<std::size_t>(node)]).z());
  }
  return {rotation, {0.0, 0.0, height - lowest}};
}

/// What a body on it says of all postures of a registration.
inline std::vector<PostureCapture> captures_of(const FingerModel& model, const Pose& X_BodyFt,
                                               double height) {
  std::vector<PostureCapture> captures;
  for (const Posture posture : RegistrationProcedure::kOrder) {
    const Pose X_WBody = lying(model, posture, height) * X_BodyFt.inverse();
    captures.push_back({.posture = posture,
                        .up_Body = X_WBody.rotation.transpose() * Vector3::UnitZ(),
                        .height = X_WBody.translation.z()});
  }
  return captures;
}

}  // namespace softfinger
