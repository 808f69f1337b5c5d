#include <algorithm>
#include <cmath>

#include "softfinger/device/mechanism/mechanism.hpp"

namespace softfinger {
namespace {

constexpr double kLeastRatio = 1e-3;  // of a determinant to home's
// Only nearer to a singularity are derivatives of determinants worth their time.
constexpr double kNearRatio = 0.1;

/// f = t / sin t and df/dt / sin t of a tilt t: smooth at 0.
struct TiltFactor {
  explicit TiltFactor(double t) {
    const double s = std::sin(t);
    if (t < 1e-3) {
      f = 1.0 + t * t / 6.0;
      rate = 1.0 / 3.0;
    } else {
      f = t / s;
      rate = (s - t * std::cos(t)) / (s * s * s);
    }
  }
  double f, rate;
};

}  // namespace

int Mechanism::constraint_count() const { return 2 * joints() + 2 + (description_.tilt ? 1 : 0); }

int Mechanism::constraint(Constraint kind, int joint) const {
  switch (kind) {
    case Constraint::kAbove:
      return joint;
    case Constraint::kBelow:
      return joints() + joint;
    case Constraint::kStretched:
      return 2 * joints();
    case Constraint::kSingular:
      return 2 * joints() + 1;
    case Constraint::kTilt:
      break;
  }
  return 2 * joints() + 2;
}

double Mechanism::joint_scale(int joint) const {
  const Linkage& linkage = description_.linkage.linkage();
  const int coordinate = description_.joints[static_cast<std::size_t>(joint)].component;
  return linkage.is_angle(coordinate) ? linkage.length() : 1.0;
}

double Mechanism::stretch_ratio(const LinkageSolution& solution) const {
  return solution.determinant / home_solution_.determinant;
}

void Mechanism::name_constraints() {
  constraint_names_.resize(static_cast<std::size_t>(constraint_count()));
  const auto names = [this](Constraint kind, int joint) -> std::vector<std::string>& {
    return constraint_names_[static_cast<std::size_t>(constraint(kind, joint))];
  };
  for (int joint = 0; joint < joints(); ++joint) {
    const std::string name = "joint_" + std::to_string(joint + 1);
    names(Constraint::kAbove, joint) = {name};
    names(Constraint::kBelow, joint) = {name};
  }
  for (const ConfigurationAxis& axis : axes()) {
    names(Constraint::kStretched, 0).push_back(axis.name);
    names(Constraint::kSingular, 0).push_back(axis.name);
  }
  if (!description_.tilt) return;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const BodyTwist by_q = twist(home_solution_, description_.tilt->body);
    if (by_q.col(k).tail<3>().norm() > 1e-9) {
      names(Constraint::kTilt, 0).push_back(axes()[static_cast<std::size_t>(k)].name);
    }
  }
}

std::span<const std::string> Mechanism::constraint_names(int k) const {
  return constraint_names_[static_cast<std::size_t>(k)];
}

void Mechanism::axis_motion(const LinkageSolution& solution, int l,
                            const LinkageCoordinates& weights, LinkageVelocity& velocity,
                            LinkageMatrix& rates) const {
  const ClosedLinkage& linkage = description_.linkage;
  linkage.linkage().velocity(solution.placement, solution.by_value.col(l), velocity);
  linkage.derivative_rates(description_.configuration, solution.placement, velocity, weights,
                           rates);
}

BodyTwist Mechanism::twist(const LinkageSolution& solution, int body) const {
  const Linkage& linkage = description_.linkage.linkage();
  const Vector3& origin = solution.placement.body[static_cast<std::size_t>(body)].translation;
  BodyTwist twist = BodyTwist::Zero(6, degrees_of_freedom());
  for (int j = 0; j < linkage.coordinate_count(); ++j) {
    if (!linkage.moves(j, body)) continue;
    twist.topRows<3>() +=
        linkage.point_velocity(j, solution.placement, origin) * solution.by_value.row(j);
    if (linkage.is_angle(j)) {
      twist.bottomRows<3>() +=
          solution.placement.direction[static_cast<std::size_t>(j)] * solution.by_value.row(j);
    }
  }
  return twist;
}

bool Mechanism::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Solved& here = solved(q);
  if (!here.closed) return false;
  const LinkageSolution& solution = here.solution;
  for (int joint = 0; joint < joints(); ++joint) {
    const double scale = joint_scale(joint);
    const double value = joint_value(solution, joint);
    const int above = constraint(Constraint::kAbove, joint);
    const int below = constraint(Constraint::kBelow, joint);
    values[above] = scale * (value - joint_limits().max[joint]);
    values[below] = scale * (joint_limits().min[joint] - value);
    jacobian.row(above) =
        scale *
        solution.by_value.row(description_.joints[static_cast<std::size_t>(joint)].component);
    jacobian.row(below) = -jacobian.row(above);
  }
  if (description_.tilt) {
    const double limit = description_.tilt->max_tilt;
    const double scale = description_.linkage.linkage().length() / limit;
    const double angle = tilt(solution);
    const Vector3 axis =
        solution.placement.body[static_cast<std::size_t>(description_.tilt->body)].rotation.col(2);
    const Vector3 lean = TiltFactor(angle).f * description_.tilt->upright.col(2).cross(axis);
    const int row = constraint(Constraint::kTilt);
    values[row] = 0.5 * scale * (angle * angle - limit * limit);
    jacobian.row(row) =
        scale * lean.transpose() * twist(solution, description_.tilt->body).bottomRows<3>();
  }

  // Where the linkage is stretched its rates grow without bound, like one over the distance's
  // root; the determinant's square goes to zero straight.
  const double stretch = stretch_ratio(solution);
  const double ratio = singularity_ratio(solution);
  const double length = description_.linkage.linkage().length();
  const int stretched = constraint(Constraint::kStretched);
  const int singular = constraint(Constraint::kSingular);
  values[stretched] = length * (kLeastRatio * kLeastRatio - stretch * stretch);
  values[singular] = length * (kLeastRatio - ratio);
  jacobian.row(stretched).setZero();
  jacobian.row(singular).setZero();
  if (stretch > kNearRatio && ratio > kNearRatio) return true;

  // Jacobi's formula, d det A = det A tr(A^-1 dA), for both determinants: that of the joints' rates
  // J = S V, which change by -S A^-1 dA V, has the trace of -J^-1 S A^-1 dA V.
  const Eigen::Index n = solution.by_value.rows();
  LinkageMatrix inverse = LinkageMatrix::Identity(n, n);
  for (Eigen::Index j = 0; j < n; ++j) solution.lu.solve(inverse.col(j));
  SmallLu<kMaxLinkageInputs> joints_lu;
  SmallLu<kMaxLinkageInputs>::Matrix joint_rows(joints(), degrees_of_freedom());
  SmallLu<kMaxLinkageInputs>::Vector column(joints());
  for (int joint = 0; joint < joints(); ++joint) {
    joint_rows.row(joint) =
        solution.by_value.row(description_.joints[static_cast<std::size_t>(joint)].component);
  }
  LinkageMatrix through_joints = LinkageMatrix::Zero(n, n);  // V J^-1 S A^-1
  if (joints_lu.factor(joint_rows)) {
    for (Eigen::Index j = 0; j < n; ++j) {
      for (int joint = 0; joint < joints(); ++joint) {
        column[joint] = inverse(description_.joints[static_cast<std::size_t>(joint)].component, j);
      }
      joints_lu.solve(column);
      through_joints.col(j).noalias() = solution.by_value * column;
    }
  }
  const LinkageCoordinates all = LinkageCoordinates::Ones(n);
  LinkageVelocity velocity;
  LinkageMatrix rates;
  for (int l = 0; l < degrees_of_freedom(); ++l) {
    axis_motion(solution, l, all, velocity, rates);
    jacobian(singular, l) = length * ratio * rates.cwiseProduct(through_joints.transpose()).sum();
    jacobian(stretched, l) =
        -2.0 * length * stretch * stretch * rates.cwiseProduct(inverse.transpose()).sum();
  }
  return true;
}

void Mechanism::add_constraint_curvature(const Configuration& q,
                                         const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                         Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Linkage& linkage = description_.linkage.linkage();
  const Solved& here = solved(q);
  if (!here.closed) return;
  const LinkageSolution& solution = here.solution;
  LinkageCoordinates weight = LinkageCoordinates::Zero(linkage.coordinate_count());
  for (int joint = 0; joint < joints(); ++joint) {
    weight[description_.joints[static_cast<std::size_t>(joint)].component] +=
        joint_scale(joint) * (std::max(0.0, multipliers[constraint(Constraint::kAbove, joint)]) -
                              std::max(0.0, multipliers[constraint(Constraint::kBelow, joint)]));
  }
  // The tilt's derivative by q is lean . spin; both change.
  double tilt_weight = 0.0;
  int body = 0;
  TiltFactor factor(0.0);
  Vector3 upright = Vector3::UnitZ();
  Vector3 axis = upright;
  if (description_.tilt) {
    body = description_.tilt->body;
    tilt_weight = std::max(0.0, multipliers[constraint(Constraint::kTilt)]) * linkage.length() /
                  description_.tilt->max_tilt;
    factor = TiltFactor(tilt(solution));
    upright = description_.tilt->upright.col(2);
    axis = solution.placement.body[static_cast<std::size_t>(body)].rotation.col(2);
  }
  const Vector3 lean = tilt_weight * factor.f * upright.cross(axis);
  for (int j = 0; j < linkage.coordinate_count(); ++j) {
    if (linkage.moves(j, body) && linkage.is_angle(j)) {
      weight[j] += lean.dot(solution.placement.direction[static_cast<std::size_t>(j)]);
    }
  }
  if (weight.isZero(0.0) && tilt_weight == 0.0) return;

  // A d2x/dq2 = -(dA/dq) dx/dq, contracted with the weights by the transposed factors.
  solution.lu.solve_transposed(weight);
  const BodyTwist by_q = twist(solution, body);
  LinkageVelocity velocity;
  LinkageMatrix rates;
  for (int l = 0; l < degrees_of_freedom(); ++l) {
    axis_motion(solution, l, weight, velocity, rates);
    LinkageCoordinates bend = -rates.transpose() * weight;
    for (int j = 0; j < linkage.coordinate_count(); ++j) {
      if (linkage.moves(j, body) && linkage.is_angle(j)) {
        bend[j] += lean.dot(velocity.direction_rate[static_cast<std::size_t>(j)]);
      }
    }
    const Vector3 spin = by_q.col(l).tail<3>();
    const Vector3 across = upright.cross(axis);
    const Vector3 lean_rate = tilt_weight * (factor.rate * across.dot(spin) * across +
                                             factor.f * upright.cross(spin.cross(axis)));
    hessian.col(l) +=
        solution.by_value.transpose() * bend + by_q.bottomRows<3>().transpose() * lean_rate;
  }
}

}  // namespace softfinger
