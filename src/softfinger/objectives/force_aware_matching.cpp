#include "softfinger/objectives/force_aware_matching.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "softfinger/base/units.hpp"
#include "softfinger/matching/limit_clamp.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/skin_points.hpp"
#include "softfinger/numerics/quadratic_program.hpp"
#include "softfinger/objectives/stress_match.hpp"

namespace softfinger {
namespace {

constexpr double kWorthwhileForce = 1e-3;  // N; a smaller force is not worth an iteration
constexpr double kForceTolerance = 1e-3;   // of the virtual force; nobody feels less
constexpr double kFarOff = 0.5;            // of the virtual force; the last frame is no start then
constexpr double kStepTolerance = 1e-6;    // m of surface motion
constexpr double kLeastDamping = 1e-4;     // of the largest diagonal
constexpr int kRejections = 4;
constexpr double kStressTolerance = 1e-3;  // of the cost; a step that gains less is the last

}  // namespace

struct ForceAwareMatching::Implementation {
  Implementation(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> the_device, int capacity,
                 const ForceAwareOptions& the_options)
      : device(std::move(the_device)),
        options(the_options),
        twin(model, device),
        dof(device->degrees_of_freedom()),
        program(dof, device->constraint_count()),
        gradient(dof),
        step(dof),
        matrix(dof, dof),
        gauss_newton(dof, dof),
        hessian(dof, dof),
        values(device->constraint_count()),
        jacobian(device->constraint_count(), dof),
        points(capacity),
        packed(capacity + static_cast<int>(ContactSet::kMostFeatures)) {
    if (options.stress_weight > 0.0) stress.emplace(model, options.stress_weight, dof);
    result.configuration = device->home();
    before = device->home();
    anchor = device->home();
  }

  std::shared_ptr<const Device> device;
  ForceAwareOptions options;
  Twin twin;
  std::optional<StressMatch> stress;
  int dof;
  QuadraticProgram program;
  Eigen::VectorXd gradient, step;
  Eigen::MatrixXd matrix, gauss_newton, hessian;
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  SkinPoints points;
  PackedSamples packed;
  SurfaceSamples samples;
  Vector3 target = Vector3::Zero();
  Configuration before;    ///< the last match
  Configuration anchor;    ///< the surface's match
  bool under_way = false;  ///< the last frame has not ended
  ForceAwareResult result;

  [[nodiscard]] double metric(int k) const {
    return device->axes()[static_cast<std::size_t>(k)].metric;
  }
  /// The cost without what the twin feels, m^2.
  [[nodiscard]] double surface_cost(const Configuration& q) const {
    return options.surface_weight * options.surface_weight * device->deviation(q, samples) +
           options.inertia_weight * options.inertia_weight * device->squared_distance(q, before) +
           options.anchor_weight * options.anchor_weight * device->squared_distance(q, anchor);
  }
  [[nodiscard]] Vector3 force_error() const { return normal_force_vector(twin.contact()) - target; }
  /// The rest of it, at the twin's last attempt, m^2.
  [[nodiscard]] double felt_cost() {
    const double force = options.force_weight * options.force_weight * force_error().squaredNorm();
    return stress ? force + stress->cost(twin) : force;
  }
  void choose_start(const Configuration& surface);
  [[nodiscard]] bool form_step(const Configuration& q, const Vector3& force,
                               const SurfaceJacobian& force_by_q, double damping);
  void cut_step();
  void search();
};

/// Damped Gauss-Newton step at q within the device's constraints, in `step` (by q).
bool ForceAwareMatching::Implementation::form_step(const Configuration& q, const Vector3& force,
                                                   const SurfaceJacobian& force_by_q,
                                                   double damping) {
  device->deviation_derivatives(q, samples, gradient, gauss_newton, hessian);
  const double per_deviation = options.surface_weight * options.surface_weight;
  gradient *= per_deviation;
  gauss_newton *= per_deviation;
  if (stress) {
    stress->linearise(twin);
    stress->add_to(gradient, gauss_newton);
  }
  const double per_newton = 2.0 * options.force_weight * options.force_weight;
  const double inertia = 2.0 * options.inertia_weight * options.inertia_weight;
  const double held = 2.0 * options.anchor_weight * options.anchor_weight;
  for (int k = 0; k < dof; ++k) {
    gradient[k] +=
        per_newton * force_by_q.col(k).dot(force - target) +
        metric(k) * metric(k) * (inertia * (q[k] - before[k]) + held * (q[k] - anchor[k]));
  }
  double largest = 0.0;
  for (int j = 0; j < dof; ++j) {
    for (int i = 0; i < dof; ++i) {
      matrix(i, j) = (gauss_newton(i, j) + per_newton * force_by_q.col(i).dot(force_by_q.col(j))) /
                     (metric(i) * metric(j));
    }
    matrix(j, j) += inertia + held;
    largest = std::max(largest, matrix(j, j));
    gradient[j] /= metric(j);
  }
  for (int k = 0; k < dof; ++k) matrix(k, k) += damping * largest;
  if (!program.factor(matrix)) return false;
  if (device->constraints(q, values, jacobian)) {
    for (int k = 0; k < dof; ++k) jacobian.col(k) /= metric(k);
    if (!program.solve(gradient, values, jacobian)) return false;
  } else {
    program.solve(gradient);
  }
  for (int k = 0; k < dof; ++k) step[k] = program.step()[k] / metric(k);
  return true;
}

/// Not further in one go than the linearised equilibrium is good for.
void ForceAwareMatching::Implementation::cut_step() {
  double longest = 1.0;
  for (int k = 0; k < dof; ++k) {
    const bool angle = device->axes()[static_cast<std::size_t>(k)].angular;
    longest =
        std::max(longest, std::abs(step[k]) / (angle ? options.max_angle : options.max_length));
  }
  step /= longest;
}

/// Where the last match was, unless the surface match is better: at first touch, and where the
/// twin has lost contact. The twin is then at result.configuration.
void ForceAwareMatching::Implementation::choose_start(const Configuration& surface) {
  const auto cost_at = [&](const Configuration& q) {
    twin.attempt(q);
    return surface_cost(q) + felt_cost();
  };
  result.configuration = before;
  const double cost = cost_at(before);
  if (force_error().norm() < kFarOff * target.norm()) return;
  if (cost_at(surface) < cost) {
    result.configuration = surface;
  } else {
    twin.attempt(before);
  }
}

/// From the twin's present attempt at result.configuration.
void ForceAwareMatching::Implementation::search() {
  Vector3 force;
  SurfaceJacobian force_by_q;
  if (!twin.force_and_derivative(force, force_by_q)) return;
  double cost = surface_cost(result.configuration) + felt_cost();
  double damping = 0.0;
  int rejections = 0;
  while (result.iterations < options.iterations && rejections < kRejections) {
    if (!form_step(result.configuration, force, force_by_q, damping)) return;
    cut_step();
    Configuration trial = result.configuration + step;
    if (!device->reachable(trial)) {
      trial = last_reachable(*device, result.configuration, trial);
    }
    const double length = std::sqrt(device->squared_distance(trial, result.configuration));
    if (length < kStepTolerance) return;
    const bool settled = twin.attempt(trial).converged;
    const double trial_cost = surface_cost(trial) + felt_cost();
    if (!settled || !(trial_cost < cost)) {
      ++rejections;
      damping = std::max(10.0 * damping, kLeastDamping * 10.0);
      continue;
    }
    ++result.iterations;
    result.configuration = trial;
    const bool gained = cost - trial_cost > kStressTolerance * cost;
    cost = trial_cost;
    damping *= 0.1;
    rejections = 0;
    if (stress ? !gained : force_error().norm() < kForceTolerance * target.norm()) return;
    if (result.iterations == options.iterations) return;
    if (!twin.force_and_derivative(force, force_by_q)) return;
  }
}

ForceAwareMatching::ForceAwareMatching(const std::shared_ptr<const FingerModel>& model,
                                       std::shared_ptr<const Device> device, int capacity,
                                       ForceAwareOptions options)
    : implementation_(
          std::make_unique<Implementation>(model, std::move(device), capacity, options)) {}
ForceAwareMatching::~ForceAwareMatching() = default;
ForceAwareMatching::ForceAwareMatching(ForceAwareMatching&&) noexcept = default;
ForceAwareMatching& ForceAwareMatching::operator=(ForceAwareMatching&&) noexcept = default;

void ForceAwareMatching::reset() {
  implementation_->twin.reset();
  implementation_->under_way = false;
  implementation_->before = implementation_->device->home();
}

const ForceAwareResult& ForceAwareMatching::match(const ContactSet& virtual_side,
                                                  const Configuration& surface,
                                                  double friction_coefficient, double elapsed,
                                                  const MatchingOptions& matching,
                                                  std::span<const Vector3> nodes_F) {
  Implementation& self = *implementation_;
  ForceAwareResult& result = self.result;
  follow(self.before);
  result = {};
  self.samples = self.packed.pack(self.points.take(virtual_side), matching,
                                  self.device->settings().matching.separation_tolerance);
  self.target = normal_force_vector(virtual_side);
  self.anchor = surface;
  self.twin.begin_frame(friction_coefficient, elapsed);
  self.under_way = true;
  if (virtual_side.contact_count > 0 && self.target.norm() > kWorthwhileForce) {
    if (self.stress) self.stress->want(nodes_F);
    self.choose_start(surface);
    self.search();
  } else {
    result.configuration = surface;
  }
  // A step that was refused is not where the frame ends.
  if (self.twin.configuration() != result.configuration) self.twin.attempt(result.configuration);
  result.force = normal_force_vector(self.twin.contact());
  result.deviation = self.device->deviation(result.configuration, self.samples);
  self.before = result.configuration;
  return result;
}

void ForceAwareMatching::follow(const Configuration& went) {
  Implementation& self = *implementation_;
  if (!self.under_way) return;
  self.under_way = false;
  self.twin.end_frame(went);
}

const Twin& ForceAwareMatching::twin() const { return implementation_->twin; }

}  // namespace softfinger
