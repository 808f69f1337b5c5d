#include "softfinger/wearer/wearer_estimate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/wearer/advance.hpp"
#include "softfinger/wearer/press_relaxation.hpp"

namespace softfinger {
namespace {

constexpr double kTouch = 0.1;  // N, of the first stage of presses
constexpr double kTouchNoise = 0.1 * mm;
constexpr double kToldNoise = 0.15 * mm;  // of a touch that the wearer tells
constexpr double kLightPress = 0.3;       // N, whose error is foretold where only touches are known
constexpr double kFurthest = 6.0 * mm;    // from the start of a press, where 0.1 N must be
constexpr int kMostParts = 3;             // into which readings of a press are put together
/// What no traits explain, of a force and N, reading by reading;
constexpr double kModelError = 0.02;
constexpr double kForceFloor = 0.01;
/// and of all forces of a press alike: straight on, and by how far it is tilted (1/rad) towards
/// skin whose shape is less well known. Trusted less, tilts tell too little of all else.
constexpr double kPressError = 0.02;
constexpr double kPressErrorByTilt = 0.25;
/// So many times as little as all that makes of them do forces tell of traits: presses next to each
/// other are unlike the model in the same way. So many that of the traits of drawn wearers nine in
/// ten are within their intervals (tools/validate --wearers).
constexpr double kToldLess = 9.0;
constexpr int kTouchSteps = 7;
constexpr int kStepsBeforeFriction = 4;
constexpr int kStepsAfterFriction = 6;
/// Each of these looks once before its first step.
constexpr int kMostLooks = kTouchSteps + kStepsBeforeFriction + kStepsAfterFriction + 3;
/// Of a step, standard deviations of any trait: after a longer one derivatives are computed, after
/// a shorter one corrected by what it taught.
constexpr double kFar = 0.25;
constexpr int kIdleSteps = 2;        // that brought next to nothing, or short ones in vain
constexpr double kLeastRatio = 0.8;  // of a force with friction to that without
constexpr double kMostRatio = 1.4;
constexpr double kLeastGain = 1e-2;          // of the cost, that a step is worth
constexpr double kGainBeforeForces = 0.1;    // the same of touches, where forces come after
constexpr double kLongestStep = 1.5;         // standard deviations, of any trait
constexpr double kLeastForceOfPress = 1e-3;  // N, all readings of a press together

/// The upper one of an even number; of one value at least.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Neighbouring readings put together, where the device felt their mean: force grows as exp(m d)
/// by advance d, so that this is m / 2 times the variance of d past the mean of d.
PressRecord in_parts(const Device& device, const PressRecord& press) {
  PressRecord parts{.start = press.start, .readings = {}};
  const std::size_t count = press.readings.size();
  const std::size_t most = std::min<std::size_t>(count, kMostParts);
  for (std::size_t part = 0; part < most; ++part) {
    PressReading mean{.q = Configuration::Zero(press.start.size()), .force = 0.0, .count = 0.0};
    for (std::size_t i = part * count / most; i < (part + 1) * count / most; ++i) {
      const PressReading& reading = press.readings[i];
      mean.q += reading.count * reading.q;
      mean.force += reading.count * reading.force;
      mean.count += reading.count;
    }
    mean.q /= mean.count;
    mean.force /= mean.count;
    Configuration spread = Configuration::Zero(press.start.size());
    for (std::size_t i = part * count / most; i < (part + 1) * count / most; ++i) {
      const PressReading& reading = press.readings[i];
      spread += reading.count * advance_between(device, mean.q, reading.q) * (reading.q - mean.q);
    }
    mean.q += 0.5 * kForceGrowth / mean.count * spread;
    parts.readings.push_back(mean);
  }
  return parts;
}

/// Where the force first passes kTouch for good, m from the start.
std::optional<double> touch_of(const Device& device, const PressRecord& press) {
  const auto& readings = press.readings;
  for (std::size_t i = readings.size(); i-- > 1;) {
    const PressReading& before = readings[i - 1];
    const PressReading& after = readings[i];
    if (before.force > kTouch || after.force <= kTouch) continue;
    const double part = (kTouch - before.force) / (after.force - before.force);
    const double from = advance_between(device, press.start, before.q);
    return from + part * (advance_between(device, press.start, after.q) - from);
  }
  if (!readings.empty() && readings.front().force > kTouch) {
    return advance_between(device, press.start, readings.front().q);
  }
  return std::nullopt;
}

std::vector<Configuration> path_of(const PressRecord& press) {
  std::vector<Configuration> path;
  for (const PressReading& reading : press.readings) path.push_back(reading.q);
  return path;
}

/// Of the surface that presses, against how it is at home, rad.
double tilt_of(const Device& device, const PressRecord& press) {
  const Vector3 home = device.surface_pose(device.home()).rotation.col(2);
  const Vector3 tilted = device.surface_pose(press.start).rotation.col(2);
  return std::acos(std::clamp(home.dot(tilted), -1.0, 1.0));
}

/// Residuals and their derivatives by the traits.
struct Residuals {
  Eigen::VectorXd r;
  Eigen::Matrix<double, Eigen::Dynamic, kWearerTraits> by_trait;

  [[nodiscard]] double cost(const TraitVector& from_known) const {
    return r.squaredNorm() + from_known.squaredNorm();
  }
};

class Estimation {
 public:
  Estimation(PressModel& model, std::span<const PressRecord> presses,
             const WearerEstimateOptions& options)
      : model_(model), options_(options) {
    for (const PressRecord& press : presses) presses_.push_back(in_parts(model.device(), press));
    for (const PressRecord& press : presses_) touches_.push_back(touch_of(model.device(), press));
    for (const PressRecord& press : presses_) {
      press_errors_.push_back(
          std::hypot(kPressError, kPressErrorByTilt * tilt_of(model.device(), press)));
    }
    if (std::ranges::none_of(touches_, [](const auto& touch) { return touch.has_value(); })) {
      throw OperationError("no press reached 0.1 N");
    }
    set_up();
  }

  /// By touches alone.
  Estimation(PressModel& model, std::span<const TouchRecord> touches,
             const WearerEstimateOptions& options)
      : model_(model), options_(options), touch_force_(kFeltForce), touch_noise_(kToldNoise) {
    for (const TouchRecord& touch : touches) {
      presses_.push_back({.start = touch.start, .readings = {}});
      touches_.emplace_back(touch.advance);
    }
    set_up();
  }

  WearerEstimate run() {
    TraitVector x = options_.known;
    const double known_error = force_error(x);
    x = minimise(x, kTouchSteps, kGainBeforeForces, [this](bool) { return touch_residuals(); });
    const auto by_forces = [this](bool derived) { return force_residuals(derived); };
    x = minimise(x, kStepsBeforeFriction, kLeastGain, by_forces);
    look_at_friction(x);
    x = minimise(x, kStepsAfterFriction, kLeastGain, by_forces);
    WearerEstimate found = judge(x);
    found.known_force_error = known_error;
    return found;
  }

  WearerEstimate run_by_touches() {
    const double known_error =
        expected_force_error(options_.known, TraitMatrix(free_.asDiagonal()));
    const TraitVector x = minimise(options_.known, kTouchSteps, kLeastGain,
                                   [this](bool) { return touch_residuals(); });
    const double rows = static_cast<double>(last_.r.size());
    const double misfit = std::max(1.0, last_.r.squaredNorm() / std::max(rows, 1.0));
    TraitMatrix normal = TraitMatrix::Identity();
    for (Eigen::Index row = 0; row < last_.r.size(); ++row) {
      const TraitVector by_trait = last_.by_trait.row(row).transpose().cwiseProduct(free_);
      normal += by_trait * by_trait.transpose() / misfit;
    }
    WearerEstimate found;
    found.x = x;
    const TraitMatrix covariance =
        free_.asDiagonal() * TraitMatrix(normal.inverse()) * free_.asDiagonal();
    found.deviation = covariance.diagonal().cwiseSqrt();
    found.known_force_error = known_error;
    found.predicted_force_error = expected_force_error(x, covariance);
    found.touch_deviation = touch_noise_ * std::sqrt(last_.r.squaredNorm() / std::max(rows, 1.0));
    found.evaluations = evaluations_;
    return found;
  }

 private:
  void set_up() {
    reached_.resize(presses_.size());
    skins_.resize(presses_.size());
    frictions_.assign(reading_count(), 1.0);
    free_.setOnes();
    if (!options_.mount_only) return;
    for (const WearerTrait trait : {WearerTrait::kLength, WearerTrait::kBreadth,
                                    WearerTrait::kDepth, WearerTrait::kModulus}) {
      free_[static_cast<Eigen::Index>(trait)] = 0.0;
    }
  }

  /// Of a light press where the model reaches one: median over the presses.
  double expected_force_error(const TraitVector& x, const TraitMatrix& covariance) {
    model_.put(x);
    std::vector<double> errors;
    for (const PressRecord& press : presses_) {
      ReachedForce light;
      if (!model_.advance_for(press.start, kLightPress, kFurthest, light)) continue;
      const double square = light.there.by_trait.dot(covariance * light.there.by_trait);
      errors.push_back(std::sqrt(std::max(square, 0.0)) / kLightPress);
    }
    return errors.empty() ? 1.0 : median(std::move(errors));
  }

  /// Median over the presses, friction aside.
  double force_error(const TraitVector& x) {
    model_.put(x);
    std::vector<double> errors;
    for (const PressRecord& press : presses_) {
      const std::vector<PredictedForce> felt = model_.press(press.start, path_of(press), false);
      double lack = 0.0;
      double force = 0.0;
      for (std::size_t i = 0; i < felt.size(); ++i) {
        lack += felt[i].force - press.readings[i].force;
        force += std::max(press.readings[i].force, 0.0);
      }
      errors.push_back(std::abs(lack) / std::max(force, kLeastForceOfPress));
    }
    return median(std::move(errors));
  }

  /// Steps of Levenberg and Marquardt. Where skin meets an edge derivatives are rough: what a step
  /// brings, be it taken or not, corrects them along it (Broyden 1965), so that a trial in vain is
  /// not repeated.
  template <typename Evaluate>
  TraitVector minimise(TraitVector x, int steps, double least_gain, const Evaluate& evaluate) {
    model_.put(x);
    Residuals now = look(evaluate, true);
    double cost = now.cost(x - options_.known);
    double damping = 1e-2;
    int idle = 0;
    for (int step = 0; step < steps && idle < kIdleSteps; ++step) {
      const TraitMatrix normal = normal_of(now);
      const TraitVector gradient =
          (now.by_trait.transpose() * now.r + (x - options_.known)).cwiseProduct(free_);
      TraitMatrix damped = normal;
      damped.diagonal() *= 1.0 + damping;
      TraitVector change = -damped.ldlt().solve(gradient).cwiseProduct(free_);
      const double longest = change.cwiseAbs().maxCoeff();
      if (!(longest > 0.0)) break;
      if (longest > kLongestStep) change *= kLongestStep / longest;
      const TraitVector trial = x + change;
      model_.put(trial);
      const bool far = longest > kFar;
      Residuals there = look(evaluate, far);
      const double trial_cost = there.cost(trial - options_.known);
      const auto taught = [&] {
        return (there.r - now.r - now.by_trait * change) * change.transpose() /
               change.squaredNorm();
      };
      if (trial_cost < cost) {
        if (!far) there.by_trait = now.by_trait + taught();
        idle = cost - trial_cost < least_gain * cost ? idle + 1 : 0;
        x = trial;
        now = std::move(there);
        cost = trial_cost;
        damping = std::max(0.1 * damping, 1e-6);
      } else {
        now.by_trait += taught();
        if (!far) ++idle;
        damping *= 4.0;
        if (damping > 1e3) break;
      }
    }
    last_ = std::move(now);
    return x;
  }

  template <typename Evaluate>
  Residuals look(const Evaluate& evaluate, bool derived) {
    ++evaluations_;
    const double fraction = evaluations_ / static_cast<double>(kMostLooks);
    if (options_.progress && !options_.progress(std::min(fraction, 1.0))) {
      throw OperationError("ended before the wearer was estimated");
    }
    return evaluate(derived);
  }

  [[nodiscard]] TraitMatrix normal_of(const Residuals& at) const {
    TraitMatrix normal = at.by_trait.transpose() * at.by_trait + TraitMatrix::Identity();
    for (int i = 0; i < kWearerTraits; ++i) {
      if (free_[i] > 0.0) continue;
      normal.row(i).setZero();
      normal.col(i).setZero();
      normal(i, i) = 1.0;
    }
    return normal;
  }

  Residuals touch_residuals() {
    const auto count = static_cast<Eigen::Index>(presses_.size());
    Residuals all{Eigen::VectorXd::Zero(count), {}};
    all.by_trait.setZero(count, kWearerTraits);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto press = static_cast<std::size_t>(k);
      const auto& touch = touches_[press];
      if (!touch) continue;
      ReachedForce& reached = reached_[press];
      if (!model_.advance_for(presses_[press].start, touch_force_, kFurthest, reached)) {
        all.r[k] = (kFurthest - *touch) / touch_noise_;
        continue;
      }
      all.r[k] = (reached.advance - *touch) / touch_noise_;
      const PredictedForce& there = reached.there;
      all.by_trait.row(k) =
          -there.by_trait.transpose() / (std::max(there.by_advance, 1.0) * touch_noise_);
    }
    return all;
  }

  [[nodiscard]] std::size_t reading_count() const {
    std::size_t count = 0;
    for (const PressRecord& press : presses_) count += press.readings.size();
    return count;
  }

  /// Of a reading by itself, N.
  [[nodiscard]] double deviation_of(const PressReading& reading) const {
    return std::hypot(options_.noise / std::sqrt(reading.count),
                      kForceFloor + kModelError * std::max(reading.force, 0.0));
  }

  /// Over their standard deviations: with those of readings D and what is alike in all of a press
  /// u, (D^2 + u u^T)^(-1/2), the root of which is that of 1 + v v^T, v = D^-1 u.
  [[nodiscard]] Residuals weighted(Residuals all) const {
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < presses_.size(); ++k) {
      const std::vector<PressReading>& readings = presses_[k].readings;
      const auto count = static_cast<Eigen::Index>(readings.size());
      auto r = all.r.segment(row, count);
      auto by_trait = all.by_trait.middleRows(row, count);
      Eigen::VectorXd v(count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const PressReading& reading = readings[static_cast<std::size_t>(i)];
        const double deviation = deviation_of(reading);
        v[i] = press_errors_[k] * std::max(reading.force, 0.0) / deviation;
        r[i] /= deviation;
        by_trait.row(i) /= deviation;
      }
      const double square = v.squaredNorm();
      if (square > 0.0) {
        const double less = (1.0 - 1.0 / std::sqrt(1.0 + square)) / square;
        r -= less * v.dot(r) * v;
        by_trait -= less * v * (v.transpose() * by_trait).eval();
      }
      row += count;
    }
    return all;
  }

  /// What friction makes of each force. It hardly depends on traits, and depends on the way; forces
  /// without do not, so that a search among them finds its end.
  void look_at_friction(const TraitVector& x) {
    model_.put(x);
    auto friction = frictions_.begin();
    for (std::size_t k = 0; k < presses_.size(); ++k) {
      const PressRecord& press = presses_[k];
      const std::vector<Configuration> path = path_of(press);
      const std::vector<PredictedForce> smooth = model_.press(press.start, path, false, skins_[k]);
      const std::vector<double> felt = model_.press_with_friction(press.start, path);
      for (std::size_t i = 0; i < path.size(); ++i) {
        const double ratio = smooth[i].force > 0.0 ? felt[i] / smooth[i].force : 1.0;
        *friction++ = std::clamp(ratio, kLeastRatio, kMostRatio);
      }
    }
  }

  Residuals force_residuals(bool derived) { return weighted(lacks(derived)); }

  /// By how much forces are foretold too great, N: without friction, times what it makes of them.
  Residuals lacks(bool derived) {
    const auto count = static_cast<Eigen::Index>(reading_count());
    Residuals all{Eigen::VectorXd::Zero(count), {}};
    all.by_trait.setZero(count, kWearerTraits);
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < presses_.size(); ++k) {
      const PressRecord& press = presses_[k];
      const std::vector<PredictedForce> felt =
          model_.press(press.start, path_of(press), derived, skins_[k]);
      for (std::size_t i = 0; i < felt.size(); ++i, ++row) {
        const double friction = frictions_[static_cast<std::size_t>(row)];
        all.r[row] = friction * felt[i].force - press.readings[i].force;
        if (derived) all.by_trait.row(row) = friction * felt[i].by_trait.transpose();
      }
    }
    return all;
  }

  WearerEstimate judge(const TraitVector& x) {
    model_.put(x);
    const Residuals lack = lacks(true);
    last_ = weighted(lack);
    const TraitMatrix normal = normal_of(last_);
    const double rows = static_cast<double>(last_.r.size());
    const double misfit = std::max(1.0, last_.r.squaredNorm() / std::max(rows, 1.0));
    const TraitMatrix told =
        TraitMatrix::Identity() + (normal - TraitMatrix::Identity()) / (kToldLess * misfit);
    WearerEstimate found;
    found.x = x;
    found.deviation = told.inverse().diagonal().cwiseSqrt().cwiseProduct(free_);
    found.evaluations = evaluations_;
    found.force_deviation = std::sqrt(lack.r.squaredNorm() / std::max(rows, 1.0));
    Eigen::Index row = 0;
    std::vector<double> errors;
    double misfits = 0.0;
    for (const PressRecord& press : presses_) {
      const auto count = static_cast<Eigen::Index>(press.readings.size());
      const Eigen::MatrixXd by_trait = last_.by_trait.middleRows(row, count) * free_.asDiagonal();
      // Where the minimum of the others is, to first order, and what that says of this press.
      const TraitMatrix others = normal - by_trait.transpose() * by_trait;
      const TraitVector change =
          others.ldlt().solve(by_trait.transpose() * last_.r.segment(row, count));
      const auto left = lack.r.segment(row, count);
      const double foretold =
          (left + lack.by_trait.middleRows(row, count) * change.cwiseProduct(free_)).sum();
      double force = 0.0;
      for (const PressReading& reading : press.readings) force += std::max(reading.force, 0.0);
      errors.push_back(std::abs(foretold) / std::max(force, kLeastForceOfPress));
      misfits += std::abs(left.sum()) / std::max(force, kLeastForceOfPress);
      row += count;
    }
    // One press may be told badly by the others and be right: half of them are what counts.
    found.predicted_force_error =
        std::max(median(std::move(errors)), misfits / static_cast<double>(presses_.size()));
    return found;
  }

  PressModel& model_;
  const WearerEstimateOptions& options_;
  std::vector<PressRecord> presses_;
  std::vector<std::optional<double>> touches_;
  double touch_force_ = kTouch;       ///< N
  double touch_noise_ = kTouchNoise;  ///< m
  TraitVector free_;
  std::vector<double> press_errors_;   ///< by press: part of a force that no traits explain
  std::vector<ReachedForce> reached_;  ///< by press: its touch
  std::vector<PressedSkin> skins_;     ///< by press
  std::vector<double> frictions_;      ///< by reading: force with friction over that without
  Residuals last_;
  int evaluations_ = 0;
};

}  // namespace

WearerEstimate estimate_wearer(PressModel& model, std::span<const PressRecord> presses,
                               const WearerEstimateOptions& options) {
  return Estimation(model, presses, options).run();
}

WearerEstimate estimate_wearer(PressModel& model, std::span<const TouchRecord> touches,
                               const WearerEstimateOptions& options) {
  return Estimation(model, touches, options).run_by_touches();
}

}  // namespace softfinger
