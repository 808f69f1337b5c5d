// One step of the finger in the shipped scenes: thread CPU time, median and 99th percentile, and
// the ratio to the plain step, whose answer is compared with ours before either is timed. And one
// step shared by two threads: wall time, beside the same step alone.

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "plain_step.hpp"
#include "scenario.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

double quantile(std::vector<double> values, double q) {
  const auto at = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<long>(at), values.end());
  return values[at];
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// A scenario run over and over, a step at a time.
class TimedRun {
 public:
  explicit TimedRun(const Scenario& scenario, ThreadTeam* team = nullptr)
      : scenario_(scenario), finger_(scenario.model, scenario.objects, scenario.time_step, team) {}

  void step() {
    if (at_ == scenario_.steps()) at_ = 0;
    if (at_ == 0) finger_.reset(scenario_.path[0]);
    ++at_;
    const double time = static_cast<double>(at_) * scenario_.time_step;
    const double wall_start = monotonic_time();
    const double start = thread_cpu_time();
    const StepSummary summary = finger_.step(scenario_.path[at_], time);
    times_.push_back((thread_cpu_time() - start) / us);
    wall_times_.push_back((monotonic_time() - wall_start) / us);
    iterations_ += summary.iterations;
    unconverged_ += summary.converged ? 0 : 1;
  }
  [[nodiscard]] double median() const { return quantile(times_, 0.5); }
  [[nodiscard]] double mean() const { return mean_of(times_); }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }            ///< us
  [[nodiscard]] const std::vector<double>& wall_times() const { return wall_times_; }  ///< us
  [[nodiscard]] const FingerSimulation& finger() const { return finger_; }

  void report(benchmark::State& state) const {
    state.counters["tetrahedra"] = static_cast<double>(std::ranges::count_if(
        scenario_.model->tetrahedron_material, [](int material) { return material >= 0; }));
    state.counters["time_step_us"] = scenario_.time_step / us;
    state.counters["median_us"] = median();
    state.counters["mean_us"] = mean();
    state.counters["p99_us"] = quantile(times_, 0.99);
    state.counters["max_us"] = quantile(times_, 1.0);
    state.counters["iterations"] = iterations_ / static_cast<double>(times_.size());
    state.counters["unconverged"] = unconverged_;
  }

 private:
  const Scenario& scenario_;
  FingerSimulation finger_;
  std::size_t at_ = 0;
  std::vector<double> times_, wall_times_;
  double iterations_ = 0.0, unconverged_ = 0.0;
};

/// Of the finger's length, the median of steps with friction: its limits are sought to a hundredth
/// of the cone, and by ways of one's own.
constexpr double kRubbing = 1e-5;

/// The plain step on some steps of a scenario, each from the engine's own state.
struct Comparison {
  std::vector<std::size_t> steps;  ///< where it ran, from 0
  std::vector<double> times;       ///< us
  double iterations = 0.0, unconverged = 0.0;
  /// Greatest distance of a node between our answer and the plain step's, which is carried on to a
  /// hundredth of the tolerance for this; over the length of the finger.
  double difference = 0.0;
  double median_difference = 0.0;  ///< over the steps
  /// Greatest residual of our answer as the plain step has it.
  double residual = 0.0;

  [[nodiscard]] bool agrees() const {
    return !times.empty() && unconverged == 0.0 && difference <= 1e-6 && residual <= 1.01e-6;
  }
  [[nodiscard]] bool agrees_rubbing() const {
    return !times.empty() && unconverged == 0.0 && median_difference <= kRubbing;
  }
  [[nodiscard]] std::string text() const {
    return "difference " + std::to_string(1e6 * difference) + "e-6, median " +
           std::to_string(1e6 * median_difference) + "e-6, residual " +
           std::to_string(1e6 * residual) + "e-6, unconverged " + std::to_string(unconverged);
  }
};

Comparison compare(const Scenario& scenario, std::size_t stride) {
  FingerSimulation finger(scenario.model, scenario.objects, scenario.time_step);
  PlainStep plain_step(scenario.model, scenario.objects, scenario.time_step);
  finger.reset(scenario.path[0]);
  plain_step.reset(scenario.path[0]);
  Comparison comparison;
  std::vector<double> differences;
  for (std::size_t k = 1; k <= scenario.steps(); ++k) {
    const double time = static_cast<double>(k) * scenario.time_step;
    finger.step(scenario.path[k], time);
    if (k % stride == 0) {
      const double start = thread_cpu_time();
      const StepSummary summary = plain_step.solve(scenario.path[k], time);
      comparison.times.push_back((thread_cpu_time() - start) / us);
      comparison.steps.push_back(k - 1);
      comparison.iterations += summary.iterations;
      if (!summary.converged || !plain_step.refine()) comparison.unconverged += 1.0;
      double apart = 0.0;
      for (std::size_t n = 0; n < plain_step.positions().size(); ++n) {
        apart = std::max(apart, (plain_step.positions()[n] - finger.positions()[n]).norm());
      }
      differences.push_back(apart);
      comparison.residual = std::max(
          comparison.residual, plain_step.residual_at(finger.positions(), finger.bone_pose()));
    }
    plain_step.advance(finger.positions(), finger.bone_pose(), scenario.path[k], time);
  }
  Eigen::AlignedBox3d extent;
  for (const Vector3& x : scenario.model->mesh.nodes) extent.extend(x);
  if (differences.empty()) return comparison;
  comparison.difference = quantile(differences, 1.0) / extent.sizes().maxCoeff();
  comparison.median_difference = quantile(differences, 0.5) / extent.sizes().maxCoeff();
  return comparison;
}

/// A step of the finger and, unless stride is 0, of the plain step on every stride-th state.
void time_steps(benchmark::State& state, const Scenario& scenario, std::size_t stride) {
  Comparison comparison, smooth;
  if (stride > 0) {
    smooth = compare(frictionless(plain(scenario)), stride);
    if (!smooth.agrees()) {
      state.SkipWithError(
          ("without friction the plain step has another answer: " + smooth.text()).c_str());
      return;
    }
    comparison = compare(plain(scenario), stride);
    if (!comparison.agrees_rubbing()) {
      state.SkipWithError(("the plain step has another answer: " + comparison.text()).c_str());
      return;
    }
  }
  TimedRun run(scenario);
  for ([[maybe_unused]] auto unused : state) run.step();
  run.report(state);
  if (stride == 0) return;
  double ours = 0.0;
  double theirs = 0.0;
  for (std::size_t i = 0; i < comparison.steps.size(); ++i) {
    if (comparison.steps[i] >= run.times().size()) break;
    ours += run.times()[comparison.steps[i]];
    theirs += comparison.times[i];
  }
  const auto count = static_cast<double>(comparison.times.size());
  state.counters["plain_us"] = quantile(comparison.times, 0.5);
  state.counters["plain_iterations"] = comparison.iterations / count;
  state.counters["plain_steps"] = count;
  state.counters["difference"] = smooth.difference;
  state.counters["rubbing_difference"] = comparison.median_difference;
  state.counters["ratio"] = theirs / ours;
}

void step(benchmark::State& state, const char* scene, const char* finger, double time_step,
          std::size_t stride) {
  time_steps(state, scripted(scene, finger, time_step), stride);
}

BENCHMARK_CAPTURE(step, S_plane, "plane", "index", 1e-3, 60)->Iterations(9000);
BENCHMARK_CAPTURE(step, S_sphere, "sphere", "index", 1e-3, 60)->Iterations(9000);
BENCHMARK_CAPTURE(step, S_edge, "edge", "index", 1e-3, 60)->Iterations(9000);
BENCHMARK_CAPTURE(step, S_plane_5kHz, "plane", "index", 2e-4, 450)->Iterations(45000);
BENCHMARK_CAPTURE(step, S_sphere_5kHz, "sphere", "index", 2e-4, 450)->Iterations(45000);
BENCHMARK_CAPTURE(step, S_edge_5kHz, "edge", "index", 2e-4, 450)->Iterations(45000);
BENCHMARK_CAPTURE(step, M_plane, "plane", "index-medium", 1e-3, 300)->Iterations(9000);
BENCHMARK_CAPTURE(step, M_sphere, "sphere", "index-medium", 1e-3, 300)->Iterations(9000);
BENCHMARK_CAPTURE(step, L_plane_16ms, "plane", "index-fine", 16e-3, 40)->Iterations(562);

void step_violent(benchmark::State& state) {
  time_steps(state, violent_on_edge("index", 1e-3, 9000), 60);
}
BENCHMARK(step_violent)->Name("step/S_violent_edge")->Iterations(9000);

/// The same path with and without friction, by turns.
void friction(benchmark::State& state, const char* scene) {
  const Scenario rough = scripted(scene, "index", 1e-3);
  const Scenario smooth = frictionless(rough);
  TimedRun with(rough);
  TimedRun without(smooth);
  for ([[maybe_unused]] auto unused : state) {
    without.step();
    with.step();
  }
  with.report(state);
  state.counters["frictionless_us"] = without.median();
  state.counters["extra_percent"] = 100.0 * (with.median() / without.median() - 1.0);
  state.counters["extra_mean_percent"] = 100.0 * (with.mean() / without.mean() - 1.0);
}
BENCHMARK_CAPTURE(friction, S_plane, "plane")->Iterations(9000);
BENCHMARK_CAPTURE(friction, S_sphere, "sphere")->Iterations(9000);
BENCHMARK_CAPTURE(friction, S_edge, "edge")->Iterations(9000);

/// Step time against mesh size: a press of the pad on a plane, from 2 mm above it, held and let go.
void press(benchmark::State& state, const char* finger, double time_step) {
  time_steps(state, scripted("plane", finger, time_step, 0.9, 2.5), 0);
}
BENCHMARK_CAPTURE(press, S_1ms, "index", 1e-3)->Iterations(1600);
BENCHMARK_CAPTURE(press, M_1ms, "index-medium", 1e-3)->Iterations(1600);
BENCHMARK_CAPTURE(press, L_1ms, "index-fine", 1e-3)->Iterations(1600);
BENCHMARK_CAPTURE(press, S_16ms, "index", 16e-3)->Iterations(100);
BENCHMARK_CAPTURE(press, M_16ms, "index-medium", 16e-3)->Iterations(100);
BENCHMARK_CAPTURE(press, L_16ms, "index-fine", 16e-3)->Iterations(100);
BENCHMARK_CAPTURE(press, R_16ms, "index-reference", 16e-3)->Iterations(100);

/// The same path with one thread and with two, by turns. Wall time, since that is what a second
/// thread is for; and what it costs, the CPU time of both.
void threads(benchmark::State& state, const Scenario& scenario) {
  ThreadTeam team(2);
  TimedRun alone(scenario);
  TimedRun shared(scenario, &team);
  double cpu_clocks = 0.0;
  for ([[maybe_unused]] auto unused : state) {
    for (std::size_t k = 0; k < scenario.steps(); ++k) alone.step();
    const std::clock_t start = std::clock();
    for (std::size_t k = 0; k < scenario.steps(); ++k) shared.step();
    cpu_clocks += static_cast<double>(std::clock() - start);
  }
  if (alone.finger().state_hash() != shared.finger().state_hash()) {
    state.SkipWithError("two threads have other bits than one");
    return;
  }
  shared.report(state);
  const auto count = static_cast<double>(shared.times().size());
  state.counters["alone_median_us"] = quantile(alone.wall_times(), 0.5);
  state.counters["alone_p99_us"] = quantile(alone.wall_times(), 0.99);
  state.counters["alone_mean_us"] = mean_of(alone.wall_times());
  state.counters["alone_cpu_us"] = alone.mean();
  state.counters["wall_median_us"] = quantile(shared.wall_times(), 0.5);
  state.counters["wall_p99_us"] = quantile(shared.wall_times(), 0.99);
  state.counters["wall_mean_us"] = mean_of(shared.wall_times());
  state.counters["both_cpu_us"] = cpu_clocks / CLOCKS_PER_SEC / us / count;
}
void threads_scene(benchmark::State& state, const char* scene, const char* finger,
                   double time_step) {
  threads(state, scripted(scene, finger, time_step));
}
void threads_press(benchmark::State& state, const char* finger, double time_step) {
  threads(state, scripted("plane", finger, time_step, 0.9, 2.5));
}
BENCHMARK_CAPTURE(threads_scene, M_plane, "plane", "index-medium", 1e-3)->Iterations(1);
BENCHMARK_CAPTURE(threads_scene, M_sphere, "sphere", "index-medium", 1e-3)->Iterations(1);
BENCHMARK_CAPTURE(threads_scene, L_plane_16ms, "plane", "index-fine", 16e-3)->Iterations(1);
BENCHMARK_CAPTURE(threads_press, M_1ms, "index-medium", 1e-3)->Iterations(2);
BENCHMARK_CAPTURE(threads_press, L_1ms, "index-fine", 1e-3)->Iterations(1);
BENCHMARK_CAPTURE(threads_press, L_16ms, "index-fine", 16e-3)->Iterations(3);
BENCHMARK_CAPTURE(threads_press, R_16ms, "index-reference", 16e-3)->Iterations(1);

}  // namespace
}  // namespace softfinger
