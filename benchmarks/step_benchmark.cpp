// One step of the finger in the shipped scenes: thread CPU time, median and 99th percentile.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "softfinger/base/thread_clock.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/scene/scene.hpp"

namespace {

using namespace softfinger;

double quantile(std::vector<double>& values, double q) {
  const auto at = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<long>(at), values.end());
  return values[at];
}

/// Runs a scene's script from start to end, a step an iteration of the benchmark.
void step_scene(benchmark::State& state, const char* scene_name, const char* finger_name) {
  const std::filesystem::path root = SOFTFINGER_SOURCE_DIR;
  const Scene scene = load_scene(root / "scenes" / (std::string(scene_name) + ".toml"));
  const auto model = FingerModel::load(root / "fingers" / (std::string(finger_name) + ".toml"));
  const double time_step = 1.0 / scene.simulation_rate;
  const Trajectory script(scene.fingers.front().waypoints);
  FingerSimulation finger(model, scene.objects, time_step);
  const auto steps = static_cast<int>(script.end_time() / time_step);
  std::vector<double> times;
  double iterations = 0.0;
  double unconverged = 0.0;
  int k = 0;
  for (auto _ : state) {
    if (k == 0) finger.reset(script.sample(0.0));
    k = k % steps + 1;
    const Pose X_WFt = script.sample(k * time_step);
    const double start = thread_cpu_time();
    const StepSummary summary = finger.step(X_WFt, k * time_step);
    times.push_back(thread_cpu_time() - start);
    iterations += summary.iterations;
    unconverged += summary.converged ? 0.0 : 1.0;
    if (k == steps) k = 0;
  }
  state.counters["median_us"] = 1e6 * quantile(times, 0.5);
  state.counters["p99_us"] = 1e6 * quantile(times, 0.99);
  state.counters["max_us"] = 1e6 * quantile(times, 1.0);
  state.counters["iterations"] = iterations / static_cast<double>(times.size());
  state.counters["unconverged"] = unconverged;
}

BENCHMARK_CAPTURE(step_scene, S_plane, "plane", "index")->Iterations(8000);
BENCHMARK_CAPTURE(step_scene, S_edge, "edge", "index")->Iterations(8000);
BENCHMARK_CAPTURE(step_scene, S_sphere, "sphere", "index")->Iterations(8000);
BENCHMARK_CAPTURE(step_scene, M_plane, "plane", "index-medium")->Iterations(8000);
BENCHMARK_CAPTURE(step_scene, M_sphere, "sphere", "index-medium")->Iterations(8000);

}  // namespace
