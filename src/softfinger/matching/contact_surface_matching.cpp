#include "softfinger/matching/contact_surface_matching.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/matching/deviation_minimiser.hpp"
#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {
namespace {

constexpr double kAtLimit = 1e-8;  // m of surface motion

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

void ContactSurfaceMatching::Implementation::finish(MatchingResult& result, MatchingLimits limits) {
  result.active_constraints = 0;
  result.joints_exist =
      limits == MatchingLimits::kNone ? device->reachable(result.configuration) : true;
  if (result.joints_exist) {
    result.joints_exist = device->inverse_kinematics(result.configuration, result.joints);
  }
  if (limits == MatchingLimits::kNone ||
      !device->constraints(result.configuration, values, jacobian)) {
    return;
  }
  const int constraints = std::min(device->constraint_count(), 64);
  for (int k = 0; k < constraints; ++k) {
    if (values[k] > -kAtLimit) result.active_constraints |= std::uint64_t{1} << k;
  }
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
  const auto run = [&](const Configuration& start, bool constrained) {
    return self.minimiser.minimise(samples, start, constrained, options.iteration_limit);
  };

  // Without limits first: where that ends in the workspace the limits are not in the way.
  MatchingResult unlimited;
  if (warm != nullptr) self.consider(unlimited, run(*warm, false));
  self.consider(unlimited, run(home, false));
  if (options.limits == MatchingLimits::kNone) {
    result = unlimited;
  } else if (options.limits == MatchingLimits::kClamp) {
    result = unlimited;
    result.configuration = clamped_to_limits(device, unlimited.configuration);
    result.deviation = device.deviation(result.configuration, samples);
  } else {
    result.iterations = unlimited.iterations;
    const bool free = device.reachable(unlimited.configuration);
    if (free) {
      DeviationMinimiser::Outcome as_is;
      as_is.q = unlimited.configuration;
      as_is.deviation = unlimited.deviation;
      as_is.termination = unlimited.termination;
      as_is.valid = true;
      self.consider(result, as_is);
    } else {
      if (warm != nullptr) self.consider(result, run(*warm, true));
      self.consider(result, run(home, true));
      self.consider(result, run(clamped_to_limits(device, unlimited.configuration), true));
    }
    if (result.configuration.size() == 0) {  // no start was feasible: home always is
      result.configuration = home;
      result.deviation = device.deviation(home, samples);
      result.termination = Termination::kNonsmooth;
    }
  }
  static_cast<void>(inside);
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
