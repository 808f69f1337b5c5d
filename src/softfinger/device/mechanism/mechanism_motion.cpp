#include "softfinger/device/mechanism/mechanism.hpp"

namespace softfinger {

// How the velocities u themselves change with q: -g . du/dq, of which du/dq has a part by the
// coordinates' second derivatives, A d2x/dq2 = -(dA/dq) dx/dq, contracted by the transposed
// factors, and one by the bodies' motion.
void Mechanism::add_motion_curvature(const Configuration& q, std::span<const BodyLoad> loads,
                                     Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const LinkageSolution& solution = solved(q).solution;
  const Linkage& linkage = description_.linkage.linkage();
  const int n = degrees_of_freedom();
  LinkageCoordinates weight = LinkageCoordinates::Zero(linkage.coordinate_count());
  for (int b = 0; b < static_cast<int>(loads.size()); ++b) {
    const auto body = static_cast<std::size_t>(b);
    if (!loads[body].touched) continue;
    const Vector3 moment = loads[body].moment();
    for (int j = 0; j < linkage.coordinate_count(); ++j) {
      if (!linkage.moves(j, b)) continue;
      const Vector3 shift =
          linkage.point_velocity(j, solution.placement, solution.placement.body[body].translation);
      weight[j] -= loads[body].force.dot(shift);
      if (linkage.is_angle(j)) {
        weight[j] -= moment.dot(solution.placement.direction[static_cast<std::size_t>(j)]);
      }
    }
  }
  solution.lu.solve_transposed(weight);

  LinkageVelocity velocity;
  LinkageMatrix rates;
  for (int l = 0; l < n; ++l) {
    axis_motion(solution, l, weight, velocity, rates);
    LinkageCoordinates bend = -rates.transpose() * weight;
    for (int b = 0; b < static_cast<int>(loads.size()); ++b) {
      const auto body = static_cast<std::size_t>(b);
      const BodyLoad& sum = loads[body];
      if (!sum.touched) continue;
      const Vector3 moment = sum.moment();
      for (int j = 0; j < linkage.coordinate_count(); ++j) {
        if (!linkage.moves(j, b)) continue;
        bend[j] -= sum.force.dot(linkage.point_velocity_rate(
            j, solution.placement, velocity, solution.placement.body[body].translation,
            velocity.velocity[body]));
        if (linkage.is_angle(j)) {
          bend[j] -= moment.dot(velocity.direction_rate[static_cast<std::size_t>(j)]);
        }
      }
      const BodyTwist& by_q = sum.by_q;
      const Vector3& v = velocity.velocity[body];
      const Vector3& spin = velocity.spin[body];
      const double trace = sum.force_arm.trace();
      // g . (w_l x v_k + w_k x v_l + w_l x (w_k x r)), summed.
      hessian.col(l) += by_q.topRows<3>().transpose() * sum.force.cross(spin) +
                        by_q.bottomRows<3>().transpose() *
                            (v.cross(sum.force) + sum.force_arm * spin - trace * spin);
    }
    hessian.col(l) += solution.by_value.transpose() * bend;
  }
}

}  // namespace softfinger
