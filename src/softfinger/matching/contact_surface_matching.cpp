#include "softfinger/matching/contact_surface_matching.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/matching/deviation_minimiser.hpp"
#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {
namespace {

constexpr double kAtLimit = 1e-8;  // m of surface motion
// Tilts of further starts, rad: around home, and around the best minimum found.
constexpr double kFarTilt = 0.35;
constexpr double kWideTilt = 0.15;
constexpr double kNearTilt = 0.06;
constexpr double kCloseTilt = 0.024;
constexpr double kRendered = 1e-16;  // m^2; less deviation than this is none

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
  Implementation(std::shared_ptr<const Device> the_device, int the_capacity)
      : device(std::move(the_device)), capacity(the_capacity), minimiser(*device) {
    for (auto* array : {&x, &y, &z, &weight, &margin}) {
      array->resize(static_cast<std::size_t>(capacity));
    }
    values.resize(device->constraint_count());
    jacobian.resize(device->constraint_count(), device->degrees_of_freedom());
  }

  std::shared_ptr<const Device> device;
  int capacity;
  DeviationMinimiser minimiser;
  std::vector<double> x, y, z, weight, margin;
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;

  SurfaceSamples pack(const ContactPoints& points, const MatchingOptions& options);
  void consider(MatchingResult& best, const DeviationMinimiser::Outcome& outcome) const;
  void look_around(const SurfaceSamples& samples, const MatchingOptions& options,
                   const Configuration& centre, double tilt, bool turned, MatchingResult& best);
  [[nodiscard]] std::uint64_t active_limits(const Configuration& q);
  void finish(MatchingResult& result, MatchingLimits limits);
};

/// Samples in contact first, in their order; then the others.
SurfaceSamples ContactSurfaceMatching::Implementation::pack(const ContactPoints& points,
                                                            const MatchingOptions& options) {
  const std::size_t count = std::min(points.points_F.size(), static_cast<std::size_t>(capacity));
  const double eps =
      options.separation_tolerance.value_or(device->settings().matching.separation_tolerance);
  double per_area = 0.0;
  if (options.weights == MatchingWeights::kArea) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += points.areas[i];
    per_area = sum > 0.0 ? static_cast<double>(count) / sum : 0.0;
  }
  std::size_t packed = 0;
  int contacts = 0;
  for (const bool touching : {true, false}) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((points.in_contact[i] != 0) != touching) continue;
      x[packed] = points.points_F[i].x();
      y[packed] = points.points_F[i].y();
      z[packed] = points.points_F[i].z();
      weight[packed] = options.weights == MatchingWeights::kArea ? points.areas[i] * per_area : 1.0;
      margin[packed] = options.separation == Separation::kScene && !points.gaps.empty()
                           ? std::max(0.0, std::min(eps, points.gaps[i]))
                           : eps;
      ++packed;
    }
    if (touching) contacts = static_cast<int>(packed);
  }
  const auto view = [&](const std::vector<double>& array) {
    return std::span<const double>(array.data(), packed);
  };
  return {view(x), view(y), view(z), view(weight), view(margin), contacts};
}

/// Keeps the better of two; of equals the one nearer home.
void ContactSurfaceMatching::Implementation::consider(
    MatchingResult& best, const DeviationMinimiser::Outcome& outcome) const {
  best.iterations += outcome.iterations;
  if (!outcome.valid) return;
  const bool first = best.configuration.size() == 0;
  const double slack = 1e-7 * outcome.deviation + 1e-17;  // m^2
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
    if (start == around) return;  // this kind does not turn
    consider(best, minimiser.minimise(samples, start, options.limits == MatchingLimits::kInside,
                                      options.iteration_limit, &best.configuration));
  }
}

std::uint64_t ContactSurfaceMatching::Implementation::active_limits(const Configuration& q) {
  std::uint64_t active = 0;
  if (!device->constraints(q, values, jacobian)) return active;
  for (int k = 0; k < std::min(device->constraint_count(), 64); ++k) {
    if (values[k] > -kAtLimit) active |= std::uint64_t{1} << k;
  }
  return active;
}

void ContactSurfaceMatching::Implementation::finish(MatchingResult& result, MatchingLimits limits) {
  const bool unlimited = limits == MatchingLimits::kNone;
  result.active_constraints = unlimited ? 0 : active_limits(result.configuration);
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

MatchingResult ContactSurfaceMatching::solve(const ContactPoints& points,
                                             const MatchingOptions& options,
                                             const Configuration* warm) {
  Implementation& self = *implementation_;
  const Device& device = *self.device;
  const SurfaceSamples samples = self.pack(points, options);
  const Configuration& home = device.home();
  MatchingResult result;
  const bool inside = options.limits == MatchingLimits::kInside;
  const auto run = [&](const Configuration& start) {
    const DeviationMinimiser::Outcome outcome =
        self.minimiser.minimise(samples, start, inside, options.iteration_limit,
                                result.configuration.size() == 0 ? nullptr : &result.configuration);
    self.consider(result, outcome);
    return outcome.known;
  };
  if (warm != nullptr) run(*warm);
  const bool agreed = run(home);           // home leads to where warm led
  if (result.configuration.size() == 0) {  // no start was feasible: home always is
    result.configuration = home;
    result.deviation = device.deviation(home, samples);
    result.termination = Termination::kNonsmooth;
  }
  // What the surface renders exactly has no better minimum. Elsewhere E may have shallow minima
  // side by side, parted by the rim: look around, and from a cold start further away.
  if (result.deviation > kRendered) {
    if (warm == nullptr) {
      self.look_around(samples, options, home, kFarTilt, false, result);
      self.look_around(samples, options, result.configuration, kWideTilt, true, result);
      self.look_around(samples, options, result.configuration, kCloseTilt, true, result);
    }
    if (!agreed) {
      self.look_around(samples, options, result.configuration, kNearTilt, false, result);
    }
    if (inside && self.active_limits(result.configuration) != 0) {
      const DeviationMinimiser::Outcome unlimited =
          self.minimiser.minimise(samples, result.configuration, false, options.iteration_limit);
      result.iterations += unlimited.iterations;
      run(clamped_to_limits(device, unlimited.q));
    }
  }
  if (options.limits == MatchingLimits::kClamp) {
    result.configuration = clamped_to_limits(device, result.configuration);
    result.deviation = device.deviation(result.configuration, samples);
  }
  self.finish(result, options.limits);
  return result;
}

std::vector<std::string> ContactSurfaceMatching::limit_names(const MatchingResult& result) const {
  std::vector<std::string> names;
  const Device& device = *implementation_->device;
  for (int k = 0; k < std::min(device.constraint_count(), 64); ++k) {
    if ((result.active_constraints >> k & 1) == 0) continue;
    for (const std::string& name : device.constraint_names(k)) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace softfinger
