// Steps of objects that move by the forces on them, with fingers and without, on one thread: CPU
// time and Newton's iterations of each step.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "world_scene.hpp"

namespace softfinger {
namespace {

/// Counters of a series: median, 99 % and the most.
void tell(benchmark::State& state, const std::string& name, const std::string& unit,
          std::vector<double>& values) {
  std::ranges::sort(values);
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  state.counters[name + "median" + unit] = at(0.5);
  state.counters[name + "p99" + unit] = at(0.99);
  state.counters[name + "max" + unit] = at(1.0);
}

void scene(benchmark::State& state, const std::string& name) {
  WorldScene shipped = WorldScene::shipped(name);
  std::vector<double> times;
  std::vector<double> iterations;
  for ([[maybe_unused]] auto unused : state) {
    const double start = thread_cpu_time();
    shipped.step();
    times.push_back((thread_cpu_time() - start) / us);
    iterations.push_back(shipped.world().summary().iterations);
  }
  tell(state, "", "_us", times);
  tell(state, "iterations_", "", iterations);
}
BENCHMARK_CAPTURE(scene, bottle, "bottle")->Name("world/bottle")->Iterations(6000);
BENCHMARK_CAPTURE(scene, handover, "handover")->Name("world/handover")->Iterations(6000);
BENCHMARK_CAPTURE(scene, cup, "cup")->Name("world/cup")->Iterations(6000);
BENCHMARK_CAPTURE(scene, tower, "tower")->Name("world/tower")->Iterations(6000);

}  // namespace
}  // namespace softfinger
