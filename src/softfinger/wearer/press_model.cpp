#include "softfinger/wearer/press_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/twin/resting_gap.hpp"
#include "softfinger/wearer/advance.hpp"
#include "softfinger/wearer/press_relaxation.hpp"

namespace softfinger {
namespace {

constexpr std::array kTissueTraits{WearerTrait::kLength, WearerTrait::kBreadth, WearerTrait::kDepth,
                                   WearerTrait::kModulus};
/// Of a standard deviation, by which tissue is different for a derivative.
constexpr double kDifference = 1e-6;
/// Edges are met as planes, where they were seen: it looks again until that changes nothing.
constexpr int kLooks = 6;
constexpr double kLookTolerance = 5e-4;         // of the force
constexpr double kJudgingLookTolerance = 1e-4;  // the same
constexpr int kMostIterations = 150;  // of a look: no press that a wearer bears takes as many
/// Of a standard deviation, by which any trait may differ for skin to be where it was, about.
constexpr double kNearby = 0.5;
/// Of a way with friction, m: contact and edges are looked for anew so often.
constexpr double kPiece = 0.12 * mm;
constexpr int kSearches = 36;                        // for a force
constexpr double kForceTolerance = 1e-2;             // of the force, of these
constexpr double kLongestAdvance = 0.4 * mm;         // of a search, at a time
constexpr double kFarAdvance = 1.0 * mm;             // foreseen: the skin is another one there
constexpr double kLeastGrowth = 0.1 * kForceGrowth;  // below, a derivative is none of a press
constexpr double kBack = 0.2 * mm;                   // until the skin is left
constexpr int kGapSteps = 12;                        // until it is met

}  // namespace

PressModel::PressModel(const std::shared_ptr<const FingerModel>& finger,
                       std::shared_ptr<const Device> device, double friction_coefficient,
                       TwinPrecision precision)
    : finger_(finger),
      device_(std::move(device)),
      friction_coefficient_(friction_coefficient),
      precision_(precision) {
  put(TraitVector::Zero());
}

void PressModel::put(const TraitVector& x) {
  x_ = x;
  const WearerTraits traits = WearerTraits::of(x);
  worn_ = traits.finger(*finger_);
  mounted_ = device_->mounted(traits.mount_fit());
  mount_motion_ = traits.mount_motion();
  twin_ = std::make_unique<Twin>(worn_, mounted_, precision_);
  same_.reset();
  others_.clear();
}

void PressModel::make_others() {
  same_ = std::make_unique<Twin>(worn_, mounted_);
  for (const WearerTrait trait : kTissueTraits) {
    TraitVector other = x_;
    other[static_cast<Eigen::Index>(trait)] += kDifference;
    others_.push_back(
        {trait, std::make_unique<Twin>(WearerTraits::of(other).finger(*finger_), mounted_)});
  }
}

PredictedForce PressModel::felt(bool with_derivatives) {
  PredictedForce felt{.force = twin_->contact().normal_force};
  if (!with_derivatives || !(felt.force > 0.0)) return felt;
  Vector6 by_mount;
  Eigen::VectorXd by_q;
  if (!twin_->force_by_mount(mounted_->settings().X_FB.translation, by_mount, by_q)) return felt;
  felt.by_trait = mount_motion_.transpose() * by_mount;
  Configuration ahead = Configuration::Zero(by_q.size());
  device_->advance(1.0, ahead);
  felt.by_advance = by_q.dot(ahead);
  if (others_.empty()) make_others();
  for (const Other& other : others_) {
    felt.by_trait[static_cast<Eigen::Index>(other.trait)] =
        twin_->force_difference(*same_, *other.twin) / kDifference;
  }
  return felt;
}

bool PressModel::settle_at(const Configuration& q) {
  const double tolerance =
      precision_ == TwinPrecision::kJudging ? kJudgingLookTolerance : kLookTolerance;
  double before = -1.0;
  for (int look = 0; look < kLooks; ++look) {
    // Without friction nothing remembers the way.
    twin_->begin_frame(0.0, 0.0);
    const TwinSummary found = twin_->attempt(q, kMostIterations);
    if (!found.converged && found.iterations >= kMostIterations) return false;
    twin_->keep();
    const double force = twin_->contact().normal_force;
    if (force > kUnbearable || std::abs(force - before) <= tolerance * force) break;
    before = force;
  }
  return true;
}

std::vector<PredictedForce> PressModel::press(const Configuration& start,
                                              std::span<const Configuration> path,
                                              bool with_derivatives) {
  PressedSkin skin;
  return press(start, path, with_derivatives, skin);
}

bool PressModel::is_near(const PressedSkin& skin) const {
  return skin.finger && (x_ - skin.x).cwiseAbs().maxCoeff() <= kNearby;
}

void PressModel::begin_from(const PressedSkin& skin, std::size_t i, const Configuration& q) {
  std::vector<Vector3> positions = skin.positions[i];
  const Vector3 grown = size_ratio(*skin.finger, *worn_);
  for (Vector3& position : positions) position = position.cwiseProduct(grown);
  twin_->reset(q, positions);
}

void PressModel::remember(PressedSkin& skin, std::size_t i) const {
  skin.positions[i].clear();
  if (!(twin_->contact().normal_force > 0.0)) return;
  skin.positions[i].assign(twin_->positions().begin(), twin_->positions().end());
}

std::vector<PredictedForce> PressModel::press(const Configuration& start,
                                              std::span<const Configuration> path,
                                              bool with_derivatives, PressedSkin& skin) {
  std::vector<PredictedForce> forces;
  const bool alike = skin.positions.size() == path.size() && is_near(skin);
  PressedSkin now{x_, worn_, std::vector<std::vector<Vector3>>(path.size())};
  twin_->reset(start);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (alike && !skin.positions[i].empty()) begin_from(skin, i, path[i]);
    const bool settled = settle_at(path[i]);
    if (!settled || twin_->contact().normal_force > kUnbearable) {
      forces.resize(path.size(), {.force = kUnbearable});
      skin = {};
      return forces;
    }
    forces.push_back(felt(with_derivatives));
    remember(now, i);
  }
  skin = std::move(now);
  return forces;
}

std::vector<double> PressModel::press_with_friction(const Configuration& start,
                                                    std::span<const Configuration> path) {
  std::vector<double> forces;
  forces.reserve(path.size());
  twin_->reset(start);
  Configuration from = start;
  for (const Configuration& q : path) {
    const double way = std::abs(advance_between(*device_, from, q));
    const double pieces = std::max(std::ceil(way / kPiece), 1.0);
    for (double piece = 1.0; piece <= pieces; ++piece) {
      twin_->press(from + piece / pieces * (q - from), friction_coefficient_, 0.0);
    }
    forces.push_back(twin_->contact().normal_force);
    from = q;
  }
  return forces;
}

bool PressModel::search(const Configuration& from, double force, double below, double most,
                        double& s) {
  const Configuration ahead = advanced(*mounted_, Configuration::Zero(from.size()), 1.0);
  double above = most;  // the force is more there, once something was
  double next = s;
  for (int i = 0; i < kSearches; ++i) {
    s = next;
    if (!settle_at(advanced(*mounted_, from, s))) return false;
    const double now = twin_->contact().normal_force;
    const double lack = force - now;
    if (std::abs(lack) < kForceTolerance * force) return true;
    (lack > 0.0 ? below : above) = s;
    if (below >= most) return false;
    double step = kLongestAdvance;
    Vector6 by_mount;
    Eigen::VectorXd by_q;
    if (now > 0.0 && twin_->force_by_mount(Vector3::Zero(), by_mount, by_q)) {
      step = std::min(step, lack / std::max(by_q.dot(ahead), 1.0));
    }
    next = std::min(s + step, most);
    if (next <= below || (above < most && next >= above)) next = 0.5 * (below + above);
  }
  return above < most;
}

bool PressModel::search_from(const ReachedForce& reached, const Configuration& from, double force,
                             double most, double& s) {
  if (!is_near(reached.skin) || !(reached.there.by_advance > kLeastGrowth * force)) return false;
  const double change = reached.there.by_trait.dot(x_ - reached.skin.x) / reached.there.by_advance;
  s = reached.advance - change;
  if (std::abs(change) > kFarAdvance || std::abs(s) >= most) return false;
  begin_from(reached.skin, 0, advanced(*mounted_, from, s));
  return search(from, force, -most, most, s);
}

bool PressModel::search_from_off_the_skin(const Configuration& from, double force, double most,
                                          double& s) {
  const std::vector<Vector3> skin = rest_skin_points(*worn_);
  RestingGap gap(*mounted_, skin);
  const auto gap_at = [&](double by) { return gap.at(advanced(*mounted_, from, by)); };
  s = 0.0;
  while (gap_at(s) < 0.0 && s > -most) s -= kBack;
  for (int i = 0; i < kGapSteps && s < most; ++i) {
    const double left = gap_at(s);
    if (left <= 0.0) break;
    s += left;
  }
  if (s >= most) return false;
  twin_->reset(advanced(*mounted_, from, s));
  const double below = s;
  s = std::min(s + 0.5 * kLongestAdvance, most);
  return search(from, force, below, most, s);
}

bool PressModel::advance_for(const Configuration& from, double force, double most,
                             ReachedForce& reached) {
  double s = 0.0;
  const bool found =
      search_from(reached, from, force, most, s) || search_from_off_the_skin(from, force, most, s);
  reached.skin = {};
  if (!found) return false;
  reached.there = felt(true);
  reached.skin = {x_, worn_, std::vector<std::vector<Vector3>>(1)};
  remember(reached.skin, 0);
  // What is left is next to nothing, and straight.
  const double left =
      std::clamp(force - reached.there.force, -kForceTolerance * force, kForceTolerance * force);
  reached.advance = s + left / std::max(reached.there.by_advance, kLeastGrowth * force);
  return true;
}

}  // namespace softfinger
