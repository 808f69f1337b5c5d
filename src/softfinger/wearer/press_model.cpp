#include "softfinger/wearer/press_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/twin/resting_gap.hpp"
#include "softfinger/wearer/advance.hpp"

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
constexpr double kPiece = 0.08 * mm;
constexpr int kSearches = 12;                 // for a force
constexpr double kForceTolerance = 1e-4;      // N, of these
constexpr double kLongestAdvance = 0.4 * mm;  // of a search, at a time
constexpr double kBack = 0.2 * mm;            // until the skin is left

}  // namespace

PressModel::PressModel(const std::shared_ptr<const FingerModel>& finger,
                       std::shared_ptr<const Device> device, std::filesystem::path device_file,
                       double friction_coefficient, TwinPrecision precision)
    : finger_(finger),
      device_(std::move(device)),
      device_file_(std::move(device_file)),
      friction_coefficient_(friction_coefficient),
      precision_(precision) {
  put(TraitVector::Zero());
}

void PressModel::put(const TraitVector& x) {
  x_ = x;
  const WearerTraits traits = WearerTraits::of(x);
  worn_ = traits.finger(*finger_);
  mounted_ = remounted(device_file_, *device_, traits.mount_fit());
  mount_motion_ = traits.mount_motion();
  twin_ = std::make_unique<Twin>(worn_, mounted_, precision_);
  same_ = std::make_unique<Twin>(worn_, mounted_);
  others_.clear();
  for (const WearerTrait trait : kTissueTraits) {
    TraitVector other = x;
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
    if (std::abs(force - before) <= tolerance * force) break;
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

std::vector<PredictedForce> PressModel::press(const Configuration& start,
                                              std::span<const Configuration> path,
                                              bool with_derivatives, PressedSkin& skin) {
  std::vector<PredictedForce> forces;
  const bool alike =
      skin.positions.size() == path.size() && (x_ - skin.x).cwiseAbs().maxCoeff() <= kNearby;
  const Vector3 grown = alike ? size_ratio(*skin.finger, *worn_) : Vector3::Ones();
  skin.positions.resize(path.size());
  twin_->reset(start);
  for (std::size_t i = 0; i < path.size(); ++i) {
    std::vector<Vector3>& positions = skin.positions[i];
    if (alike && !positions.empty()) {
      for (Vector3& position : positions) position = position.cwiseProduct(grown);
      twin_->reset(path[i], positions);
    }
    const bool settled = settle_at(path[i]);
    if (!settled || twin_->contact().normal_force > kUnbearable) {
      forces.resize(path.size(), {.force = kUnbearable});
      skin.positions.clear();
      return forces;
    }
    forces.push_back(felt(with_derivatives));
    positions.clear();
    if (forces.back().force > 0.0) {
      positions.assign(twin_->positions().begin(), twin_->positions().end());
    }
  }
  skin.x = x_;
  skin.finger = worn_;
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

bool PressModel::advance_for(const Configuration& from, double force, double most, double& advance,
                             PredictedForce& there) {
  const std::vector<Vector3> skin = rest_skin_points(*worn_);
  RestingGap gap(*mounted_, skin);
  const auto at = [&](double s) {
    Configuration q = from;
    mounted_->advance(s, q);
    return q;
  };
  double s = 0.0;
  while (gap.at(at(s)) < 0.0 && s > -most) s -= kBack;
  for (int i = 0; i < kSearches && s < most; ++i) {
    const double left = gap.at(at(s));
    if (left <= 0.0) break;
    s += left;
  }
  twin_->reset(at(s));
  double below = s;  // the force is less there
  double above = most;
  s += 0.5 * kLongestAdvance;
  for (int i = 0; i < 3 * kSearches; ++i) {
    if (s >= most) return false;
    if (!settle_at(at(s))) return false;
    there = felt(false);
    const double lack = force - there.force;
    if (std::abs(lack) < kForceTolerance) break;
    (lack > 0.0 ? below : above) = s;
    double step = kLongestAdvance;
    if (there.force > 0.0) {
      Vector6 by_mount;
      Eigen::VectorXd by_q;
      Configuration ahead = Configuration::Zero(from.size());
      mounted_->advance(1.0, ahead);
      if (twin_->force_by_mount(Vector3::Zero(), by_mount, by_q)) {
        step = std::min(step, lack / std::max(by_q.dot(ahead), 1.0));
      }
    }
    double next = s + step;
    if (!(next > below && next < above)) next = 0.5 * (below + std::min(above, s + step));
    if (next <= below) next = 0.5 * (below + above);
    s = next;
  }
  there = felt(true);
  advance = s;
  return true;
}

}  // namespace softfinger
