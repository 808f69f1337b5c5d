#include "softfinger/wearer/press_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/twin/resting_gap.hpp"
#include "softfinger/wearer/advance.hpp"

namespace softfinger {
namespace {

constexpr std::array kTissueTraits{WearerTrait::kLength, WearerTrait::kBreadth, WearerTrait::kDepth,
                                   WearerTrait::kModulus};
/// Of a standard deviation, by which tissue is different for a derivative.
constexpr double kDifference = 1e-5;
/// Edges are met as planes, where they were seen: it looks again until that changes nothing.
constexpr int kLooks = 6;
constexpr double kLookTolerance = 1e-4;  // of the force
/// Of a way with friction, m: contact and edges are looked for anew so often.
constexpr double kPiece = 0.08 * mm;
constexpr int kSearches = 12;                 // for a force
constexpr double kForceTolerance = 1e-4;      // N, of these
constexpr double kLongestAdvance = 0.4 * mm;  // of a search, at a time

}  // namespace

PressModel::PressModel(const std::shared_ptr<const FingerModel>& finger,
                       std::shared_ptr<const Device> device, std::filesystem::path device_file,
                       double friction_coefficient)
    : finger_(finger),
      device_(std::move(device)),
      device_file_(std::move(device_file)),
      friction_coefficient_(friction_coefficient) {
  put(TraitVector::Zero());
}

void PressModel::put(const TraitVector& x) {
  const WearerTraits traits = WearerTraits::of(x);
  worn_ = traits.finger(*finger_);
  mounted_ = remounted(device_file_, *device_, traits.mount_fit());
  mount_motion_ = traits.mount_motion();
  twin_ = std::make_unique<Twin>(worn_, mounted_);
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

void PressModel::settle_at(const Configuration& q) {
  double before = -1.0;
  for (int look = 0; look < kLooks; ++look) {
    // Without friction nothing remembers the way.
    twin_->begin_frame(0.0, 0.0);
    twin_->attempt(q);
    twin_->keep();
    const double force = twin_->contact().normal_force;
    if (std::abs(force - before) <= kLookTolerance * force) break;
    before = force;
  }
}

std::vector<PredictedForce> PressModel::press(const Configuration& start,
                                              std::span<const Configuration> path,
                                              bool with_derivatives) {
  std::vector<PredictedForce> forces;
  forces.reserve(path.size());
  twin_->reset(start);
  for (const Configuration& q : path) {
    settle_at(q);
    forces.push_back(felt(with_derivatives));
  }
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
  for (int i = 0; i < kSearches && s < most; ++i) {
    const double left = gap.at(at(s));
    if (left <= 0.0) break;
    s += left;
  }
  twin_->reset(from);
  double below = s;  // the force is less there
  double above = most;
  s += 0.5 * kLongestAdvance;
  for (int i = 0; i < 3 * kSearches; ++i) {
    if (s >= most) return false;
    settle_at(at(s));
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
