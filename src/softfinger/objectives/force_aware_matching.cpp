#include "softfinger/objectives/force_aware_matching.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "softfinger/base/units.hpp"
#include "softfinger/matching/limit_clamp.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/skin_points.hpp"
#include "softfinger/numerics/quadratic_program.hpp"
#include "softfinger/objectives/secant_forces.hpp"
#include "softfinger/objectives/shear_directions.hpp"
#include "softfinger/objectives/stress_match.hpp"

namespace softfinger {
namespace {

constexpr double kWorthwhileForce = 1e-3;  // N; a smaller force is not worth an iteration
/// Of the virtual force. People tell forces apart by 7 % and more (Jones, "Matching forces:
/// constant errors and differential thresholds", Perception 1989): nobody feels this.
constexpr double kForceTolerance = 5e-3;
constexpr double kFarOff = 0.2;          // of the virtual force; the last frame is no start then
constexpr double kStepTolerance = 1e-6;  // m of surface motion
constexpr double kLeastDamping = 1e-4;   // of the largest diagonal
// A frame. More gain nothing in the mean, and cost the slowest frames a third of their time.
constexpr int kAttempts = 5;
// Of Newton's method, in all attempts of a frame: a frame that would take more ends with the best
// it has, and the next goes on.
constexpr int kIterations = 120;
// Of the attempt at the surface's match: where that presses the skin far, it is no start.
constexpr int kIterationsOfALook = 30;
// Of the cost; a step that gains less is not made.
constexpr double kCostTolerance = 5e-3;
constexpr double kStressTolerance = 1e-3;

}  // namespace

struct ForceAwareMatching::Implementation {
  Implementation(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> the_device, int capacity,
                 const ForceAwareOptions& the_options)
      : device(std::move(the_device)),
        options(the_options),
        twin(model, device, TwinPrecision::kSearching),
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
        shear(options.tangential_weight > 0.0 ? shear_projection(*model, *device)
                                              : Matrix3(Matrix3::Zero())),
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
  Matrix3 shear;  ///< onto the directions in which the tangential force counts
  PackedSamples packed;
  SurfaceSamples samples;
  Vector3 target = Vector3::Zero();             ///< normal force
  Vector3 tangential_target = Vector3::Zero();  ///< what of the tangential force counts
  Configuration before;                         ///< the last match
  Configuration anchor;                         ///< the surface's match
  bool under_way = false;                       ///< the last frame has not ended
  bool attempted = false;                       ///< in this frame
  int spent = 0;                                ///< iterations of the twin, in this frame
  SecantForces known;                           ///< at result.configuration and thereabouts
  bool foreknown = false;                       ///< by the last frame
  bool derived = false;                         ///< right at result.configuration
  double damping = 0.0;                         ///< of the next step, of the largest diagonal
  double gain = 0.0;  ///< m^2 of cost, of `step` by the linearised problem
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
  [[nodiscard]] Vector3 tangential_error() const {
    return shear * twin.contact().tangential_force_F - tangential_target;
  }
  /// The rest of it, at the twin's last attempt, m^2.
  [[nodiscard]] double felt_cost() {
    const double force =
        options.force_weight * options.force_weight * force_error().squaredNorm() +
        options.tangential_weight * options.tangential_weight * tangential_error().squaredNorm();
    return stress ? force + stress->cost(twin) : force;
  }
  /// Nobody feels what is still amiss.
  [[nodiscard]] bool is_met() const {
    const double amiss = force_error().squaredNorm() + tangential_error().squaredNorm();
    return std::sqrt(amiss) < kForceTolerance * target.norm();
  }
  /// Nobody feels what a step gains that gains less, m^2.
  [[nodiscard]] double worthwhile(double cost) const {
    const double felt = options.force_weight * kForceTolerance * target.norm();
    return std::max(felt * felt, (stress ? kStressTolerance : kCostTolerance) * cost);
  }
  [[nodiscard]] double cost_at(const Configuration& q) { return surface_cost(q) + felt_cost(); }
  /// Whether the twin's skin came to rest there.
  bool attempt(const Configuration& q, int most_iterations = Twin::kAsManyAsItTakes) {
    attempted = true;
    const TwinSummary summary = twin.attempt(q, most_iterations);
    spent += summary.iterations;
    return summary.converged;
  }
  void choose_start(const Configuration& surface);
  [[nodiscard]] bool form_step(const Configuration& q);
  void add_forces();
  void cut_step();
  [[nodiscard]] bool derive();
  [[nodiscard]] bool form_trial(double cost, Configuration& trial);
  void search();
  void take_forces();
};

/// Adds the forces' part to gradient and Gauss-Newton matrix of the cost.
void ForceAwareMatching::Implementation::add_forces() {
  const auto add = [&](double weight, const Vector3& error, const SurfaceJacobian& by_q) {
    if (!(weight > 0.0)) return;
    const double per_newton = 2.0 * weight * weight;
    for (int j = 0; j < dof; ++j) {
      gradient[j] += per_newton * by_q.col(j).dot(error);
      for (int i = 0; i < dof; ++i) {
        gauss_newton(i, j) += per_newton * by_q.col(i).dot(by_q.col(j));
      }
    }
  };
  const TwinForces& forces = known.forces;
  add(options.force_weight, forces.normal - target, forces.normal_by_q);
  if (shear.isZero(0.0)) return;
  add(options.tangential_weight, shear * forces.tangential - tangential_target,
      shear * forces.tangential_by_q);
}

/// Damped Gauss-Newton step at q within the device's constraints, in `step` (by q).
bool ForceAwareMatching::Implementation::form_step(const Configuration& q) {
  device->deviation_derivatives(q, samples, gradient, gauss_newton, hessian);
  const double per_deviation = options.surface_weight * options.surface_weight;
  gradient *= per_deviation;
  gauss_newton *= per_deviation;
  if (stress) {
    stress->linearise(twin);
    stress->add_to(gradient, gauss_newton);
  }
  add_forces();
  const double inertia = 2.0 * options.inertia_weight * options.inertia_weight;
  const double held = 2.0 * options.anchor_weight * options.anchor_weight;
  for (int k = 0; k < dof; ++k) {
    gradient[k] +=
        metric(k) * metric(k) * (inertia * (q[k] - before[k]) + held * (q[k] - anchor[k]));
  }
  double largest = 0.0;
  for (int j = 0; j < dof; ++j) {
    for (int i = 0; i < dof; ++i) matrix(i, j) = gauss_newton(i, j) / (metric(i) * metric(j));
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
  gain = 0.0;
  for (int k = 0; k < dof; ++k) {
    gain -= 0.5 * gradient[k] * program.step()[k];
    step[k] = program.step()[k] / metric(k);
  }
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
/// twin has lost contact. The twin is then at result.configuration, or as the last frame left it.
void ForceAwareMatching::Implementation::choose_start(const Configuration& surface) {
  const auto near = [&] { return force_error().norm() < kFarOff * target.norm(); };
  result.configuration = before;
  foreknown = foreknown && twin.configuration() == before && near();
  if (foreknown) return;
  attempt(before);
  if (near()) return;
  const double cost = cost_at(before);
  if (attempt(surface, kIterationsOfALook) && cost_at(surface) < cost) {
    result.configuration = surface;
  } else {
    attempt(before);
  }
}

/// The twin is at result.configuration.
void ForceAwareMatching::Implementation::take_forces() {
  known.forces.normal = normal_force_vector(twin.contact());
  known.forces.tangential = twin.contact().tangential_force_F;
}

/// The derivatives at result.configuration.
bool ForceAwareMatching::Implementation::derive() {
  if (twin.configuration() != result.configuration) attempt(result.configuration);
  foreknown = twin.forces_and_derivatives(known.forces);
  known.doubtful = false;
  derived = true;
  damping = 0.0;
  return foreknown;
}

/// A configuration worth trying, with the derivatives as they are.
bool ForceAwareMatching::Implementation::form_trial(double cost, Configuration& trial) {
  if (!form_step(result.configuration) || gain < worthwhile(cost)) return false;
  cut_step();
  trial = result.configuration + step;
  if (!device->reachable(trial)) trial = last_reachable(*device, result.configuration, trial);
  return std::sqrt(device->squared_distance(trial, result.configuration)) >= kStepTolerance;
}

/// From result.configuration, with the derivatives that are known from the last frame.
void ForceAwareMatching::Implementation::search() {
  derived = false;
  damping *= 0.1;
  if (!foreknown && !derive()) return;
  double cost = cost_at(result.configuration);
  Configuration trial = result.configuration;
  for (int attempts = 0;
       attempts < kAttempts && result.iterations < options.iterations && spent < kIterations;
       ++attempts) {
    if (!form_trial(cost, trial)) {
      if (!known.doubtful || derived || is_met() || !derive()) return;
      if (spent >= kIterations) return;
      cost = cost_at(result.configuration);
      if (!form_trial(cost, trial)) return;
    }
    const bool settled = attempt(trial, kIterations - spent);
    const double trial_cost = cost_at(trial);
    const bool foretold = settled && known.learn(*device, trial - result.configuration,
                                                 normal_force_vector(twin.contact()),
                                                 twin.contact().tangential_force_F);
    if (!settled || !(trial_cost < cost)) {
      damping = std::max(10.0 * damping, kLeastDamping * 10.0);
      continue;
    }
    ++result.iterations;
    result.configuration = trial;
    derived = false;
    take_forces();
    const bool gained = cost - trial_cost > kStressTolerance * cost;
    cost = trial_cost;
    damping = damping < kLeastDamping ? 0.0 : 0.1 * damping;
    if (stress ? !gained : is_met()) return;
    if ((stress || foretold) && !derive()) return;
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
  implementation_->foreknown = false;
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
  self.tangential_target = self.shear * virtual_side.tangential_force_F;
  self.anchor = surface;
  self.twin.begin_frame(friction_coefficient, elapsed);
  self.under_way = true;
  self.attempted = false;
  self.spent = 0;
  if (virtual_side.contact_count > 0 && self.target.norm() > kWorthwhileForce) {
    if (self.stress) self.stress->want(nodes_F);
    self.choose_start(surface);
    self.search();
  } else {
    result.configuration = surface;
    self.foreknown = false;
  }
  // A step that was refused is not where the frame ends.
  if (!self.attempted || self.twin.configuration() != result.configuration) {
    self.attempt(result.configuration);
  }
  result.force = normal_force_vector(self.twin.contact());
  result.tangential_force = self.twin.contact().tangential_force_F;
  self.take_forces();
  self.foreknown = self.foreknown && !self.stress;
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

double ForceAwareMatching::deviation(const Configuration& q) const {
  return implementation_->device->deviation(q, implementation_->samples);
}

const Twin& ForceAwareMatching::twin() const { return implementation_->twin; }

}  // namespace softfinger
