#include "softfinger/device/mechanism/mechanism.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kGridAngle = 0.1;   // rad; spacing of solved configurations
constexpr double kGridLength = 0.1;  // of the linkage's length
// Limits count as inside to this much (rad, m): rounding of degrees in files and flags must not put
// a pose on its limit out of the workspace.
constexpr double kLimitTolerance = 1e-9;

using JointsByConfiguration = SmallLu<kMaxLinkageInputs>::Matrix;

JointsByConfiguration joints_by_configuration(const std::vector<LinkageReading>& joints,
                                              const LinkageSolution& solution) {
  JointsByConfiguration jacobian(static_cast<Eigen::Index>(joints.size()),
                                 solution.by_value.cols());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    jacobian.row(static_cast<Eigen::Index>(i)) = solution.by_value.row(joints[i].component);
  }
  return jacobian;
}

double determinant(const JointsByConfiguration& matrix) {
  SmallLu<kMaxLinkageInputs> lu;
  return lu.factor(matrix) ? lu.determinant() : 0.0;
}

/// A new one for each mechanism, from 1.
std::uint64_t next_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

LinkageSolution at_home(const MechanismDescription& description) {
  LinkageSolution solution;
  solution.x = description.home;
  static_cast<void>(description.linkage.complete(description.configuration, solution));
  return solution;
}

}  // namespace

Mechanism::Mechanism(const DeviceSettings& settings, MechanismDescription description)
    : Kinematics(settings),
      number_(next_number()),
      description_(std::move(description)),
      home_solution_(at_home(description_)),
      home_determinant_(determinant(joints_by_configuration(description_.joints, home_solution_))),
      grid_(explored()) {
  name_constraints();
  find_legs();
}

double Mechanism::scaled_home_determinant() const {
  const Linkage& linkage = description_.linkage.linkage();
  double scaled = home_determinant_;
  for (const LinkageReading& joint : description_.joints) {
    if (linkage.is_angle(joint)) scaled *= linkage.length();
  }
  for (const LinkageReading& reading : description_.configuration) {
    if (linkage.is_angle(reading)) scaled /= linkage.length();
  }
  return scaled;
}

SolvedGrid Mechanism::explored() const {
  const Linkage& linkage = description_.linkage.linkage();
  LinkageInputs spacing(degrees_of_freedom());
  for (Eigen::Index k = 0; k < spacing.size(); ++k) {
    spacing[k] = linkage.is_angle(description_.configuration[static_cast<std::size_t>(k)])
                     ? kGridAngle
                     : kGridLength * linkage.length();
  }
  return {description_.linkage, description_.configuration, home_solution_, spacing,
          [this](const LinkageSolution& solution) { return within_limits(solution); }};
}

const Mechanism::Solved& Mechanism::solved(const Configuration& q) const {
  // Matching asks for limits, surface and their derivatives at one q, one after the other.
  thread_local Solved last;
  if (last.mechanism != number_ || last.q != q) {
    last.mechanism = number_;
    last.q = q;
    last.closed = solve_afresh(q, last.solution);
  }
  return last;
}

bool Mechanism::solve(const Configuration& q, LinkageSolution& solution) const {
  const Solved& here = solved(q);
  solution = here.solution;
  return here.closed;
}

bool Mechanism::solve_afresh(const LinkageInputs& wanted, LinkageSolution& solution) const {
  if (!wanted.allFinite()) {
    solution = home_solution_;
    return false;
  }
  grid_.load(grid_.start(wanted, false), solution);
  if (description_.linkage.follow(description_.configuration, wanted, solution)) return true;
  const LinkageCoordinates beyond = solution.by_value * (wanted - solution.values);
  description_.linkage.linkage().move(solution.x, beyond);
  static_cast<void>(description_.linkage.complete(description_.configuration, solution));
  solution.values = wanted;
  return false;
}

double Mechanism::joint_value(const LinkageSolution& solution, int joint) const {
  return solution.x[description_.joints[static_cast<std::size_t>(joint)].component];
}

void Mechanism::fill_joints(const LinkageSolution& solution, JointAngles& values) const {
  values.resize(joints());
  for (int joint = 0; joint < joints(); ++joint) values[joint] = joint_value(solution, joint);
}

double Mechanism::singularity_ratio(const LinkageSolution& solution) const {
  if (home_determinant_ == 0.0) return 0.0;
  return determinant(joints_by_configuration(description_.joints, solution)) / home_determinant_;
}

bool Mechanism::within_limits(const LinkageSolution& solution) const {
  if (description_.tilt && tilt(solution) > description_.tilt->max_tilt + kLimitTolerance)
    return false;
  for (int joint = 0; joint < joints(); ++joint) {
    const double value = joint_value(solution, joint);
    if (value < joint_limits().min[joint] - kLimitTolerance ||
        value > joint_limits().max[joint] + kLimitTolerance) {
      return false;
    }
  }
  return singularity_ratio(solution) > 0.0;
}

double Mechanism::tilt(const LinkageSolution& solution) const {
  if (!description_.tilt) return 0.0;
  const Vector3 upright = description_.tilt->upright.col(2);
  const Vector3 axis =
      solution.placement.body[static_cast<std::size_t>(description_.tilt->body)].rotation.col(2);
  return std::atan2(upright.cross(axis).norm(), upright.dot(axis));
}

bool Mechanism::inverse_kinematics(const Configuration& q, JointAngles& joint_values) const {
  joint_values.resize(joints());
  LinkageSolution solution;
  if (q.size() != degrees_of_freedom() || !solve(q, solution)) return false;
  fill_joints(solution, joint_values);
  return true;
}

void Mechanism::clamped_joints(const Configuration& q, JointAngles& joint_values) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  fill_joints(solution, joint_values);
  joint_values = joint_values.cwiseMax(joint_limits().min).cwiseMin(joint_limits().max);
}

bool Mechanism::forward_kinematics(const JointAngles& joint_values, Configuration& q) const {
  if (joint_values.size() != joints() || !joint_values.allFinite()) return false;
  const LinkageInputs wanted = joint_values;
  const ClosedLinkage& linkage = description_.linkage;
  // From the solved configuration with the nearest joints, else from home.
  const auto lack = [&](const LinkageCoordinates& x) {
    double sum = 0.0;
    for (int joint = 0; joint < joints(); ++joint) {
      const double d =
          joint_scale(joint) *
          (x[description_.joints[static_cast<std::size_t>(joint)].component] - wanted[joint]);
      sum += d * d;
    }
    return sum;
  };
  int nearest = 0;
  for (int node = 1; node < grid_.size(); ++node) {
    if (grid_.node(node).inside && lack(grid_.node(node).x) < lack(grid_.node(nearest).x)) {
      nearest = node;
    }
  }
  for (const int node : {nearest, 0}) {
    LinkageSolution solution;
    solution.x = grid_.node(node).x;
    if (!linkage.complete(description_.joints, solution)) continue;
    if (!linkage.follow(description_.joints, wanted, solution)) continue;
    q.resize(degrees_of_freedom());
    linkage.linkage().read(description_.configuration, solution.x, solution.placement, q);
    // The same joints on home's branch, not only the same q on another.
    LinkageSolution back;
    if (reachable(q) && solve(q, back) && lack(back.x) < 1e-8 * 1e-8) return true;
  }
  return false;
}

Configuration Mechanism::facing(const Vector3& normal_F, const Configuration& q) const {
  const SurfacePiece& piece = description_.surface.front();
  int roll = -1;
  int pitch = -1;
  const LinkageReading* reading = nullptr;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const LinkageReading& axis = description_.configuration[static_cast<std::size_t>(k)];
    if (axis.kind != LinkageReading::Kind::kRotation || axis.body != piece.body) continue;
    if (axis.component == 0) roll = k;
    if (axis.component == 1) pitch = k;
    if (axis.component != 2) reading = &axis;
  }
  if (reading == nullptr) return q;
  const Vector3 level = reading->reference.rotation * piece.X_LS.rotation.col(2);
  const Vector3 wanted = mount().rotation.transpose() * normal_F;
  const double most = description_.tilt ? description_.tilt->max_tilt : 80.0 * deg;
  Configuration turned = q;
  const Vector3 across = level.cross(wanted);
  if (roll >= 0 && pitch >= 0) {
    const double sine = across.norm();
    const double angle = std::min(std::atan2(sine, level.dot(wanted)), most);
    // Straight away from the finger no direction is nearer than another: stay level.
    turned[roll] = sine > 1e-12 ? angle * across.x() / sine : 0.0;
    turned[pitch] = sine > 1e-12 ? angle * across.y() / sine : 0.0;
    return turned;
  }
  const int axis = pitch >= 0 ? pitch : roll;
  const int component = pitch >= 0 ? 1 : 0;
  const double cosine = level.dot(wanted) - level[component] * wanted[component];
  turned[axis] = std::clamp(std::atan2(across[component], cosine), -most, most);
  return turned;
}

Pose Mechanism::pose(const Configuration& q) const {
  const LinkageSolution& solution = solved(q).solution;
  return solution.placement.body[static_cast<std::size_t>(description_.surface.front().body)];
}

RigidMotion Mechanism::motion(const Configuration& q) const {
  const BodyTwist by_q = twist(q, description_.surface.front().body);
  RigidMotion motion{.X_BP = pose(q), .count = degrees_of_freedom()};
  for (int k = 0; k < std::min(motion.count, RigidMotion::kMostAxes); ++k) {
    motion.rate[static_cast<std::size_t>(k)] = {skew(by_q.col(k).tail<3>()) * motion.X_BP.rotation,
                                                by_q.col(k).head<3>()};
  }
  return motion;
}

void Mechanism::place(const Configuration& q, std::span<Pose> bodies) const {
  const LinkageSolution& solution = solved(q).solution;
  std::copy_n(solution.placement.body.begin(), bodies.size(), bodies.begin());
}

BodyTwist Mechanism::twist(const Configuration& q, int body) const {
  const LinkageSolution& solution = solved(q).solution;
  return twist(solution, body);
}

void Mechanism::find_legs() {
  const Linkage& linkage = description_.linkage.linkage();
  std::vector<bool> drawn(static_cast<std::size_t>(linkage.body_count()), false);
  int last_loop = -1;
  for (int e = 0; e < linkage.equation_count(); ++e) {
    const LoopEquation& equation = linkage.equation(e);
    if (equation.loop == last_loop) continue;
    last_loop = equation.loop;
    add_chain({equation.a, equation.point_a}, drawn);
    add_chain({equation.b, equation.point_b}, drawn);
  }
  for (const SurfacePiece& piece : description_.surface) {
    if (!drawn[static_cast<std::size_t>(piece.body)]) {
      add_chain({piece.body, piece.X_LS.translation}, drawn);
    }
  }
}

void Mechanism::add_chain(const BodyPoint& end, std::vector<bool>& drawn) {
  const Linkage& linkage = description_.linkage.linkage();
  constexpr double kLeastLink = 1e-6;  // m; shorter ones are joints in one place
  std::vector<BodyPoint> chain;        // from the end to the base
  const auto place = [this](const BodyPoint& at) {
    return home_solution_.placement.body[static_cast<std::size_t>(at.body)] * at.point;
  };
  const auto add = [&](const BodyPoint& at) {
    if (chain.empty() || (place(at) - place(chain.back())).norm() > kLeastLink) chain.push_back(at);
  };
  add(end);
  for (int body = end.body; body != 0; body = linkage.body(body).parent) {
    // What floats has no link to what it floats over.
    if (linkage.body(body).type == JointType::kFree) break;
    add({body, Vector3::Zero()});
    if (linkage.body(body).type == JointType::kPrismatic) {
      add({linkage.body(body).parent, linkage.body(body).X_PJ.translation});
    }
    if (drawn[static_cast<std::size_t>(body)]) break;
    drawn[static_cast<std::size_t>(body)] = true;
  }
  std::reverse(chain.begin(), chain.end());
  for (std::size_t at = 0; at + 1 < chain.size(); at += 2) {
    const std::size_t last = std::min(at + 2, chain.size() - 1);
    legs_.push_back(Leg{{chain[at], chain[at + 1], chain[last]}});
  }
}

void Mechanism::linkage(const Configuration& q, std::span<Vector3> points_F) const {
  const LinkageSolution& solution = solved(q).solution;
  for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
    for (std::size_t k = 0; k < 3; ++k) {
      const BodyPoint& at = legs_[leg][k];
      const Pose& X_BL = solution.placement.body[static_cast<std::size_t>(at.body)];
      points_F[3 * leg + k] = mount() * (X_BL * at.point);
    }
  }
}

}  // namespace softfinger
