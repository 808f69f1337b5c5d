#include "softfinger/matching/contact_surface_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "softfinger/matching/deviation_minimiser.hpp"
#include "softfinger/matching/limit_clamp.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/pin_minimiser.hpp"

namespace softfinger {
namespace {

constexpr double kAtLimit = 1e-8;  // m of surface motion
// Tilts of further starts, rad: around home, and around the best minimum found.
constexpr double kFarTilt = 0.35;
constexpr double kWideTilt = 0.15;
constexpr double kNearTilt = 0.06;
constexpr double kCloseTilt = 0.024;
// Points a grid has along each axis, by their number, half as many with a warm start; and how many
// of them become starts.
constexpr std::array<int, 4> kGridPoints{0, 24, 12, 6};
constexpr std::size_t kGridStarts = 3;
constexpr double kSamePoint = 1e-10;  // m of surface motion
constexpr double kRendered = 1e-16;   // m^2; less deviation than this is none
constexpr int kAdvances = 20;         // steps along one direction
constexpr double kAdvanced = 1e-9;    // m; a step that is none

}  // namespace

std::string_view to_string(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kIterationLimit:
      return "iteration_limit";
    case Termination::kNonsmooth:
      break;
  }
  return "nonsmooth";
}

struct ContactSurfaceMatching::Implementation {
  Implementation(std::shared_ptr<const Device> the_device, int capacity)
      : device(std::move(the_device)), packed(capacity) {
    if (device->pin_field() != nullptr) {
      pins.emplace(*device, capacity);
    } else {
      minimiser.emplace(*device);
      values.resize(device->constraint_count());
      jacobian.resize(device->constraint_count(), device->degrees_of_freedom());
      const int n = device->degrees_of_freedom();
      gradient.resize(n);
      gauss_newton.resize(n, n);
      hessian.resize(n, n);
    }
  }

  std::shared_ptr<const Device> device;
  // One of the two.
  std::optional<DeviationMinimiser> minimiser;
  std::optional<PinMinimiser> pins;
  PackedSamples packed;
  bool limited = false;  ///< a limit was in the way of some start of this solve
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd gauss_newton, hessian;

  SurfaceSamples pack(const ContactPoints& points, const MatchingOptions& options) {
    return packed.pack(points, options, device->settings().matching.separation_tolerance);
  }
  void consider(MatchingResult& best, const DeviationMinimiser::Outcome& outcome);
  void look_around(const SurfaceSamples& samples, const MatchingOptions& options,
                   const Configuration& centre, double tilt, bool turned, MatchingResult& best);
  void look_over_grid(const SurfaceSamples& samples, const MatchingOptions& options, bool warm,
                      MatchingResult& best);
  void search(const SurfaceSamples& samples, const MatchingOptions& options,
              const Configuration* warm, MatchingResult& result);
  void consider_clamped(const SurfaceSamples& samples, const MatchingOptions& options,
                        const Configuration* warm, MatchingResult& result);
  void search_pins(const SurfaceSamples& samples, const MatchingOptions& options,
                   const Configuration* warm, MatchingResult& result);
  [[nodiscard]] ConstraintSet active_limits(const Configuration& q);
  void finish(MatchingResult& result, MatchingLimits limits);
};

/// Keeps the better of two; of equals the one nearer home.
void ContactSurfaceMatching::Implementation::consider(MatchingResult& best,
                                                      const DeviationMinimiser::Outcome& outcome) {
  best.iterations += outcome.iterations;
  limited = limited || outcome.limited;
  if (!outcome.valid) return;
  const bool first = best.configuration.size() == 0;
  const double slack = 1e-13 * outcome.deviation + 1e-19;  // m^2
  const bool better = !first && outcome.deviation < best.deviation - slack;
  const bool as_good = !first && !better && outcome.deviation <= best.deviation + slack;
  const auto from_home = [&](const Configuration& q) {
    return device->squared_distance(q, device->home());
  };
  if (first || better ||
      (as_good && from_home(outcome.q) < from_home(best.configuration) - 1e-16)) {
    best.configuration = outcome.q;
    best.deviation = outcome.deviation;
    best.termination = outcome.termination;
  }
}

/// Starts at `centre` turned by `tilt` (rad) to four sides; `turned`: to the four between these.
void ContactSurfaceMatching::Implementation::look_around(const SurfaceSamples& samples,
                                                         const MatchingOptions& options,
                                                         const Configuration& centre, double tilt,
                                                         bool turned, MatchingResult& best) {
  // A copy, since `centre` may be the best result's own configuration.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const Configuration around = centre;
  const Matrix3 facing_F = device->surface_pose(around).rotation;
  for (int side = 0; side < 4; ++side) {
    const double azimuth = (0.5 * side + (turned ? 0.25 : 0.0)) * std::numbers::pi;
    const Vector3 sideways =
        std::cos(azimuth) * facing_F.col(0) + std::sin(azimuth) * facing_F.col(1);
    const Vector3 normal_F = std::cos(tilt) * facing_F.col(2) + std::sin(tilt) * sideways;
    const Configuration start = device->facing(normal_F, around);
    if (start == around) continue;  // this kind does not turn there
    consider(best, minimiser->minimise(samples, start, options.limits == MatchingLimits::kInside,
                                       options.iteration_limit, &best.configuration));
  }
}

/// Starts at the best points of a grid over the limits of the axes, where all have some.
void ContactSurfaceMatching::Implementation::look_over_grid(const SurfaceSamples& samples,
                                                            const MatchingOptions& options,
                                                            bool warm, MatchingResult& best) {
  const int n = device->degrees_of_freedom();
  if (n >= static_cast<int>(kGridPoints.size())) return;
  for (const ConfigurationAxis& axis : device->axes()) {
    if (!std::isfinite(axis.min) || !std::isfinite(axis.max)) return;
  }
  const bool inside = options.limits == MatchingLimits::kInside;
  const int points = kGridPoints[static_cast<std::size_t>(n)] / (warm ? 2 : 1);
  std::array<Configuration, kGridStarts> starts;
  std::array<double, kGridStarts> found;
  found.fill(std::numeric_limits<double>::infinity());
  Configuration q(n);
  int total = 1;
  for (int k = 0; k < n; ++k) total *= points;
  for (int index = 0; index < total; ++index) {
    for (int k = 0, rest = index; k < n; ++k, rest /= points) {
      const ConfigurationAxis& axis = device->axes()[static_cast<std::size_t>(k)];
      q[k] = axis.min + (axis.max - axis.min) * (rest % points + 0.5) / points;
    }
    double value = device->deviation(q, samples);
    if (value >= found.back()) continue;
    if (inside && !device->reachable(q)) {
      limited = true;
      continue;
    }
    Configuration at = q;
    for (std::size_t place = 0; place < found.size(); ++place) {
      if (value >= found[place]) continue;
      std::swap(value, found[place]);
      at.swap(starts[place]);
    }
  }
  for (std::size_t place = 0; place < found.size() && std::isfinite(found[place]); ++place) {
    consider(best, minimiser->minimise(samples, starts[place], inside, options.iteration_limit,
                                       &best.configuration));
  }
}

ConstraintSet ContactSurfaceMatching::Implementation::active_limits(const Configuration& q) {
  ConstraintSet active;
  if (pins) {
    const auto n = static_cast<std::size_t>(q.size());
    for (std::size_t k = 0; k < n; ++k) {
      const ConfigurationAxis& axis = device->axes()[k];
      const double height = q[static_cast<Eigen::Index>(k)];
      active.set(k, height > axis.max - kAtLimit);
      active.set(n + k, height < axis.min + kAtLimit);
    }
    return active;
  }
  if (!device->constraints(q, values, jacobian)) return active;
  for (int k = 0; k < device->constraint_count(); ++k) {
    active.set(static_cast<std::size_t>(k), values[k] > -kAtLimit);
  }
  return active;
}

void ContactSurfaceMatching::Implementation::finish(MatchingResult& result, MatchingLimits limits) {
  const bool unlimited = limits == MatchingLimits::kNone;
  result.active_constraints = unlimited ? ConstraintSet{} : active_limits(result.configuration);
  result.joints_exist = (!unlimited || device->reachable(result.configuration)) &&
                        device->inverse_kinematics(result.configuration, result.joints);
}

ContactSurfaceMatching::ContactSurfaceMatching(std::shared_ptr<const Device> device, int capacity)
    : implementation_(std::make_unique<Implementation>(std::move(device), capacity)) {}
ContactSurfaceMatching::~ContactSurfaceMatching() = default;
ContactSurfaceMatching::ContactSurfaceMatching(ContactSurfaceMatching&&) noexcept = default;
ContactSurfaceMatching& ContactSurfaceMatching::operator=(ContactSurfaceMatching&&) noexcept =
    default;

const Device& ContactSurfaceMatching::device() const { return *implementation_->device; }

/// From all starts, for a surface that moves as a whole.
void ContactSurfaceMatching::Implementation::search(const SurfaceSamples& samples,
                                                    const MatchingOptions& options,
                                                    const Configuration* warm,
                                                    MatchingResult& result) {
  const Configuration& home = device->home();
  const bool inside = options.limits == MatchingLimits::kInside;
  const auto run = [&](const Configuration& start) {
    const DeviationMinimiser::Outcome outcome =
        minimiser->minimise(samples, start, inside, options.iteration_limit,
                            result.configuration.size() == 0 ? nullptr : &result.configuration);
    consider(result, outcome);
    return outcome.known;
  };
  if (warm != nullptr) run(*warm);
  const bool agreed = run(home);           // home leads to where warm led
  if (result.configuration.size() == 0) {  // no start was feasible: home always is
    result.configuration = home;
    result.deviation = device->deviation(home, samples);
    result.termination = Termination::kNonsmooth;
  }
  // What the surface renders exactly has no better minimum. Elsewhere E may have shallow minima
  // side by side, parted by the rim: look around, and from a cold start further away.
  if (result.deviation <= kRendered) return;
  if (warm == nullptr) {
    look_around(samples, options, home, kFarTilt, false, result);
    look_around(samples, options, result.configuration, kWideTilt, true, result);
    look_around(samples, options, result.configuration, kCloseTilt, true, result);
  }
  if (!agreed) look_around(samples, options, result.configuration, kNearTilt, false, result);
  look_over_grid(samples, options, warm != nullptr, result);
  if (inside && limited && (warm == nullptr || active_limits(result.configuration).any())) {
    consider_clamped(samples, options, warm, result);
  }
}

/// What cutting joint angles gives, and where it leads: never worse than that.
void ContactSurfaceMatching::Implementation::consider_clamped(const SurfaceSamples& samples,
                                                              const MatchingOptions& options,
                                                              const Configuration* warm,
                                                              MatchingResult& result) {
  MatchingOptions unlimited_options = options;
  unlimited_options.limits = MatchingLimits::kNone;
  MatchingResult unlimited;
  search(samples, unlimited_options, warm, unlimited);
  result.iterations += unlimited.iterations;
  const Configuration clamped = clamped_to_limits(*device, unlimited.configuration);
  const Configuration before = result.configuration;
  const DeviationMinimiser::Outcome descended =
      minimiser->minimise(samples, clamped, true, options.iteration_limit, &before);
  DeviationMinimiser::Outcome here{.q = clamped,
                                   .deviation = device->deviation(clamped, samples),
                                   .iterations = 0,
                                   .termination = Termination::kNonsmooth,
                                   .valid = true};
  // A minimum itself where one of these is the same point.
  const auto is_here = [&](const Configuration& q) {
    return device->squared_distance(q, clamped) < kSamePoint * kSamePoint;
  };
  if (is_here(unlimited.configuration)) here.termination = unlimited.termination;
  if (is_here(descended.q)) here.termination = descended.termination;
  if (is_here(before)) here.termination = result.termination;
  consider(result, descended);
  consider(result, here);
}

/// From all starts, for a field of pins.
void ContactSurfaceMatching::Implementation::search_pins(const SurfaceSamples& samples,
                                                         const MatchingOptions& options,
                                                         const Configuration* warm,
                                                         MatchingResult& result) {
  pins->take(samples, options.limits != MatchingLimits::kNone);
  const auto run = [&](const Configuration& start) {
    const PinMinimiser::Outcome outcome = pins->minimise(start, options.iteration_limit);
    consider(result, {.q = outcome.q,
                      .deviation = outcome.deviation,
                      .iterations = outcome.iterations,
                      .termination = outcome.converged ? Termination::kConverged
                                                       : Termination::kIterationLimit,
                      .valid = true});
  };
  run(pins->assigned());
  run(warm != nullptr ? *warm : device->home());
}

MatchingResult ContactSurfaceMatching::solve(const ContactPoints& points,
                                             const MatchingOptions& options,
                                             const Configuration* warm) {
  Implementation& self = *implementation_;
  const SurfaceSamples samples = self.pack(points, options);
  MatchingResult result;
  self.limited = false;
  if (self.pins) {
    self.search_pins(samples, options, warm, result);
  } else {
    self.search(samples, options, warm, result);
  }
  if (options.limits == MatchingLimits::kClamp) {
    result.configuration = clamped_to_limits(*self.device, result.configuration);
    result.deviation = self.device->deviation(result.configuration, samples);
  }
  self.finish(result, options.limits);
  return result;
}

double ContactSurfaceMatching::deviation(const ContactPoints& points,
                                         const MatchingOptions& options, const Configuration& q) {
  return device().deviation(q, implementation_->pack(points, options));
}

MatchingResult ContactSurfaceMatching::answer(const ContactPoints& points,
                                              const MatchingOptions& options,
                                              const Configuration& q) {
  Implementation& self = *implementation_;
  MatchingResult result;
  result.configuration =
      options.limits == MatchingLimits::kClamp ? clamped_to_limits(*self.device, q) : q;
  result.deviation = deviation(points, options, result.configuration);
  self.finish(result, options.limits);
  return result;
}

Configuration ContactSurfaceMatching::advanced(const ContactPoints& points,
                                               const MatchingOptions& options,
                                               const Configuration& q) {
  Implementation& self = *implementation_;
  const SurfaceSamples samples = self.pack(points, options);
  Configuration at = q;
  if (self.pins || !self.device->advances() || samples.contact_count == 0) return at;
  Configuration ahead = Configuration::Zero(q.size());
  self.device->advance(1.0, ahead);
  double least = self.device->deviation(at, samples);
  // E along one line is smooth but where samples of N come and go.
  for (int i = 0; i < kAdvances; ++i) {
    self.device->deviation_derivatives(at, samples, self.gradient, self.gauss_newton, self.hessian);
    double curvature = 0.0;  // of the whole product Eigen would allocate
    for (int k = 0; k < ahead.size(); ++k)
      curvature += ahead[k] * self.gauss_newton.col(k).dot(ahead);
    if (!(curvature > 0.0)) break;
    double step = -self.gradient.dot(ahead) / curvature;
    Configuration trial = at;
    double value = least;
    for (int halving = 0; halving < kAdvances && std::abs(step) > kAdvanced; ++halving) {
      trial = at + step * ahead;
      value = self.device->deviation(trial, samples);
      if (value < least) break;
      step *= 0.5;
    }
    if (!(value < least)) break;
    at = trial;
    least = value;
  }
  return at;
}

std::vector<std::string> ContactSurfaceMatching::limit_names(const MatchingResult& result) const {
  std::vector<std::string> names;
  const Device& device = *implementation_->device;
  for (int k = 0; k < device.constraint_count(); ++k) {
    if (!result.active_constraints.test(static_cast<std::size_t>(k))) continue;
    for (const std::string& name : device.constraint_names(k)) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace softfinger
