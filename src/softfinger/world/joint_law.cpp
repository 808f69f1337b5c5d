#include "softfinger/world/joint_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace softfinger {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

JointLaw::JointLaw(const Joint& joint, double limit_stiffness)
    : limits_(joint.limits),
      limit_stiffness_(limit_stiffness),
      onset_(joint.kind == JointKind::kHinge ? kHingeOnset : kOnset),
      stick_(joint.kind == JointKind::kHinge ? kHingeStick : kStick),
      spring_(joint.spring),
      rest_(joint.rest),
      friction_limit_(joint.friction),
      detents_(joint.detents.value_or(JointDetents{})) {
  if (joint.curve) curve_.emplace(*joint.curve);
}

LawValue JointLaw::evaluate(double q) const {
  const double way = q - rest_;
  LawValue sum{0.5 * spring_ * way * way, spring_ * way, spring_};
  const auto add = [&](const LawValue& value, double sign) {
    sum.energy += value.energy;
    sum.force += sign * value.force;
    sum.stiffness += value.stiffness;
  };
  if (curve_) {
    const ForceCurve::Value at = curve_->at(-q);
    add({at.work, at.force, at.slope}, -1.0);
  }
  if (detents_.count > 0) add(detents(q), 1.0);
  if (limits_) add(limits(q), 1.0);
  return sum;
}

double JointLaw::limit_force(double q) const { return limits_ ? limits(q).force : 0.0; }

LawValue JointLaw::limits(double q) const {
  const auto [least, greatest] = *limits_;
  if (q >= least && q <= greatest) return {};
  const double beyond = q < least ? least - q : q - greatest;
  const double sign = q < least ? -1.0 : 1.0;
  const double k = limit_stiffness_;
  const double w = onset_;
  if (beyond < w) {
    const double part = beyond / w;
    return {k * w * w * part * part * part / 6.0, sign * 0.5 * k * w * part * part, k * part};
  }
  return {k * (0.5 * beyond * (beyond - w) + w * w / 6.0), sign * k * (beyond - 0.5 * w), k};
}

LawValue JointLaw::detents(double q) const {
  const double n = detents_.count;
  const double torque = detents_.torque;
  return {torque / n * (1.0 - std::cos(n * q)), torque * std::sin(n * q),
          torque * n * std::cos(n * q)};
}

double JointLaw::least_of_detents(double from, double to) const {
  const double n = detents_.count;
  // A top between two rest positions, (k + 1/2) 2 pi / n, lies between these two.
  const double top = std::ceil(n * from / kTurn - 0.5) + 0.5;
  const bool has_top = !std::isfinite(from) || !std::isfinite(to) || top * kTurn <= n * to;
  const double least = has_top ? -1.0 : std::min(std::cos(n * from), std::cos(n * to));
  return n * detents_.torque * least;
}

double JointLaw::least_stiffness() const {
  const double from = limits_ ? (*limits_)[0] - onset_ : -kInfinity;
  const double to = limits_ ? (*limits_)[1] + onset_ : kInfinity;
  double least = spring_;
  if (curve_) least += curve_->least_slope(-to, -from);
  if (detents_.count > 0) least += least_of_detents(from, to);
  return least;
}

LawValue JointLaw::friction(double q, double anchor) const {
  if (!(friction_limit_ > 0.0)) return {};
  const double stiffness = friction_limit_ / stick_;
  const double way = q - anchor;
  if (std::abs(way) <= stick_) {
    return {0.5 * stiffness * way * way, stiffness * way, stiffness};
  }
  return {friction_limit_ * (std::abs(way) - 0.5 * stick_), std::copysign(friction_limit_, way),
          0.0};
}

double JointLaw::anchor_after(double q, double anchor) const {
  return std::clamp(anchor, q - stick_, q + stick_);
}

std::span<const ForceCurve::Snap> JointLaw::snaps() const {
  return curve_ ? curve_->snaps() : std::span<const ForceCurve::Snap>();
}

long JointLaw::detent(double q) const {
  return detents_.count > 0 ? std::lround(q * detents_.count / kTurn) : 0;
}

double JointLaw::beyond_limits(double q) const {
  return limits_ ? std::max((*limits_)[0] - q, q - (*limits_)[1]) : -kInfinity;
}

}  // namespace softfinger
