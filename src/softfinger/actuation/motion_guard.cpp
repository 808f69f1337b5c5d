#include "softfinger/actuation/motion_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/actuation/nearby_pose.hpp"

namespace softfinger {
namespace {

/// No part of a fingertip device moves further than this (m); bounds wanted values before use.
constexpr double kLargestMotion = 0.2;
/// Halvings in a search on a segment: a millionth of its length.
constexpr int kHalvings = 20;
/// Points at which a way is looked at before a detour is given up.
constexpr int kWayPoints = 16;
/// Less of the allowed joint travel than this counts as being blocked.
constexpr double kBlocked = 1e-2;
/// Towards home by this much a try, where rounding to the wire would break a limit, or a pose is
/// exactly on one.
constexpr double kPullBack = 2e-3;
constexpr int kPullBacks = 4;
/// Wanted poses stay this much (m) below the ceiling, so that rounding does not lead over it.
constexpr double kBelowCeiling = 2e-5;
/// What excess over the ceiling (m) is none.
constexpr double kOnCeiling = 1e-9;

Configuration between(const Configuration& from, const Configuration& to, double fraction) {
  if (fraction == 1.0) return to;  // to the last bit
  return from + fraction * (to - from);
}

/// Part of the straight way before the first of some points on it that is not allowed; 1: all of
/// it.
template <typename Allowed>
double open_part(const Configuration& from, const Configuration& to, const Allowed& allowed) {
  for (int i = 1; i <= kWayPoints; ++i) {
    if (!allowed(between(from, to, static_cast<double>(i) / kWayPoints))) {
      return static_cast<double>(i - 1) / kWayPoints;
    }
  }
  return 1.0;
}

/// Largest fraction in [0, 1] that is allowed, by halving; 0 is taken as allowed.
template <typename Allowed>
double largest_fraction(const Allowed& allowed) {
  if (allowed(1.0)) return 1.0;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (allowed(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

MotionGuard::MotionGuard(std::shared_ptr<const Device> device,
                         std::span<const ServoSettings> servos,
                         std::shared_ptr<const TravelCeiling> ceiling)
    : device_(std::move(device)),
      servos_(servos.begin(), servos.end()),
      ceiling_(std::move(ceiling)) {
  const auto& transport = device_->settings().transport;
  if (transport && transport->follows_travel) travel_axis_ = device_->approach_axis();
  reset(device_->home());
}

bool MotionGuard::allowed(const Configuration& q) const {
  return device_->reachable(q) && (!ceiling_ || ceiling_->excess(q) <= most_excess_);
}

void MotionGuard::take(const Command& command, double dt) {
  if (dt > 0.0) {
    rates_ = (command.joints - now_.joints) / dt;
  } else {
    rates_.setZero(command.joints.size());
  }
  now_ = command;
  most_excess_ = kOnCeiling;
  if (ceiling_) most_excess_ = std::max(most_excess_, ceiling_->excess(now_.q));
}

void MotionGuard::reset(const Configuration& q) {
  by_home_ = false;
  arrived_ = true;
  most_excess_ = std::numeric_limits<double>::infinity();
  Command command;
  form_near(q, command, [](const Command&) { return true; });
  take(command, 0.0);
}

Configuration MotionGuard::allowed_goal(const Configuration& wanted) const {
  Configuration goal = wanted;
  for (Eigen::Index i = 0; i < goal.size(); ++i) {
    const double farthest = kLargestMotion / device_->axes()[static_cast<std::size_t>(i)].metric;
    goal[i] = std::clamp(goal[i], -farthest, farthest);
  }
  if (ceiling_) ceiling_->lower(goal, kBelowCeiling);
  const Configuration& home = device_->home();
  const double fraction =
      largest_fraction([&](double t) { return allowed(between(home, goal, t)); });
  goal = between(home, goal, fraction);
  return between(home, goal, way_from_home(goal));
}

double MotionGuard::allowed_travel(Eigen::Index joint, bool up, double dt) const {
  const JointLimits& limits = device_->joint_limits();
  const double rate = up ? rates_[joint] : -rates_[joint];
  const double faster = std::max(0.0, rate) + limits.max_acceleration * dt;
  const double travel = std::min(limits.max_rate, faster) * dt;
  if (servos_.empty() || travel_axis_) return travel;
  // Each rounding moves a joint by at most one step of the wire.
  const double rounding = 2.0 * servos_[static_cast<std::size_t>(joint)].resolution();
  return travel - std::min(rounding, 0.5 * travel);
}

bool MotionGuard::within_travel(const JointAngles& joints, double dt) const {
  for (Eigen::Index i = 0; i < joints.size(); ++i) {
    const double travel = joints[i] - now_.joints[i];
    if (!(std::abs(travel) <= allowed_travel(i, travel > 0.0, dt))) return false;
  }
  return true;
}

double MotionGuard::allowed_fraction(const Configuration& goal, double dt) const {
  return largest_fraction([&](double t) {
    const Configuration q = between(now_.q, goal, t);
    JointAngles joints;
    return allowed(q) && device_->inverse_kinematics(q, joints) && within_travel(joints, dt);
  });
}

bool MotionGuard::way_is_clear(const Configuration& goal) const {
  return open_part(now_.q, goal, [&](const Configuration& q) { return allowed(q); }) == 1.0;
}

double MotionGuard::way_from_home(const Configuration& q) const {
  return open_part(device_->home(), q,
                   [&](const Configuration& at) { return device_->reachable(at); });
}

bool MotionGuard::is_blocked(const Configuration& next, const Configuration& goal,
                             double dt) const {
  JointAngles reached;
  if (!device_->inverse_kinematics(next, reached)) return true;
  const JointLimits& limits = device_->joint_limits();
  const double travel = (reached - now_.joints).cwiseAbs().maxCoeff();
  return travel < kBlocked * std::min(limits.max_rate, limits.max_acceleration * dt) * dt &&
         !way_is_clear(goal);
}

bool MotionGuard::form(const Configuration& q, Command& command) const {
  command.q = q;
  if (!allowed(q) || !device_->inverse_kinematics(q, command.joints)) return false;
  if (servos_.empty()) return true;
  if (travel_axis_) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    command.targets[0] = servos_[0].target(q[*travel_axis_], -kAny, kAny);
    return true;
  }
  const JointLimits& limits = device_->joint_limits();
  JointAngles sent = command.joints;
  for (int i = 0; i < sent.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    command.targets[at] = servos_[at].target(sent[i], limits.min[i], limits.max[i]);
    sent[i] = servos_[at].joint_of_target(command.targets[at]);
  }
  // Rounding moves the platform too: what counts is the pose of the targets that go out.
  Configuration rounded;
  return nearby_pose(*device_, sent, q, rounded) && allowed(rounded);
}

template <typename Fits>
bool MotionGuard::form_near(const Configuration& q, Command& command, const Fits& fits) const {
  for (int i = 0; i <= kPullBacks; ++i) {
    if (form(between(q, device_->home(), kPullBack * i), command) && fits(command)) return true;
  }
  return false;
}

void MotionGuard::step(const Configuration& wanted, double dt) {
  arrived_ = false;
  if (!(dt > 0.0)) return;
  if (wanted.size() != now_.q.size() || !wanted.allFinite()) {
    rates_.setZero();
    return;
  }
  const Configuration goal = allowed_goal(wanted);
  by_home_ = by_home_ && !way_is_clear(goal);

  Configuration next;
  const auto head_for = [&](const Configuration& stage) {
    const double fraction = allowed_fraction(stage, dt);
    next = between(now_.q, stage, fraction);
    return fraction;
  };
  double fraction = head_for(by_home_ ? device_->home() : goal);
  // Never to where the way home is blocked: a device must always get away from the finger.
  const auto loses_home = [&] { return !sees_home(next) && sees_home(now_.q); };
  if (!by_home_ && (is_blocked(next, goal, dt) || loses_home())) {
    by_home_ = true;
    fraction = head_for(device_->home());
  }

  Command command;
  const auto fits = [&](const Command& one) { return within_travel(one.joints, dt); };
  if (form_near(next, command, fits)) {
    take(command, dt);
    arrived_ = fraction == 1.0 && !by_home_;
  } else {
    rates_.setZero();
  }
}

}  // namespace softfinger
