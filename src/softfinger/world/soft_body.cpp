#include "softfinger/world/soft_body.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/soft_solid.hpp"

namespace softfinger {

SoftBody::SoftBody(std::span<const VirtualObject> objects, std::size_t object,
                   const Vector3& gravity, double time_step, ThreadTeam* team)
    : motion_(&objects[object].motion),
      object_(object),
      simulation_(objects, object, gravity, time_step, team),
      surface_(objects[object].soft->mesh, SoftSolid::kTouchingGroup) {
  const std::span<const double> masses = simulation_.potential().elastic().masses();
  for (std::size_t n = 0; n < masses.size(); ++n) {
    mass_ += masses[n];
    centre_O_ += masses[n] * simulation_.model().mesh.nodes[n];
  }
  centre_O_ /= mass_;
}

void SoftBody::reset() {
  simulation_.reset(motion_->sample(0.0));
  renew_surface();
  mark();
}

double SoftBody::way() const {
  double square = 0.0;
  const std::span<const Vector3> positions = simulation_.positions();
  for (std::size_t n = 0; n < positions.size(); ++n) {
    square = std::max(square, (positions[n] - marks_[n]).squaredNorm());
  }
  return std::sqrt(square);
}

double SoftBody::speed() const {
  double square = 0.0;
  for (const Vector3& v : simulation_.velocities()) square = std::max(square, v.squaredNorm());
  return std::sqrt(square);
}

void SoftBody::begin_step(double time) { simulation_.begin_step(motion_->sample(time), time); }

ObjectState SoftBody::state() const {
  const std::span<const double> masses = simulation_.potential().elastic().masses();
  const std::span<const Vector3> positions = simulation_.positions();
  const std::span<const Vector3> velocities = simulation_.velocities();
  Vector3 centre = Vector3::Zero();
  ObjectState state;
  for (std::size_t n = 0; n < masses.size(); ++n) {
    centre += masses[n] / mass_ * positions[n];
    state.velocity += masses[n] / mass_ * velocities[n];
  }
  Matrix3 spread = Matrix3::Zero();
  Matrix3 second = Matrix3::Zero();
  Vector3 momentum = Vector3::Zero();  // about the centre
  for (std::size_t n = 0; n < masses.size(); ++n) {
    const Vector3 way = positions[n] - centre;
    const Vector3 rest = simulation_.model().mesh.nodes[n] - centre_O_;
    spread += masses[n] * way * rest.transpose();
    second += masses[n] * way * way.transpose();
    momentum += masses[n] * way.cross(velocities[n]);
  }
  const Eigen::JacobiSVD<Matrix3> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  state.X_WO.rotation = U * svd.matrixV().transpose();
  state.X_WO.translation = centre - state.X_WO.rotation * centre_O_;
  const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
  state.angular_velocity = inertia.ldlt().solve(momentum);
  return state;
}

}  // namespace softfinger
