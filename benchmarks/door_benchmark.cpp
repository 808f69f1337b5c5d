// A step through the interfaces for other programs: the same exploration by C++ and by C, step by
// step in turn, with the contact read after each. CPU time of one thread, medians, us.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../tests/support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/rendering.hpp"
#include "softfinger/softfinger.h"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

const std::string kSphere = source_folder() + "/scenes/sphere.toml";

double median_of(std::vector<double>& times) {
  const auto middle = times.begin() + static_cast<long>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

/// CPU time of a call, us.
template <typename Call>
double timed(Call&& call) {
  const double start = thread_cpu_time();
  call();
  return (thread_cpu_time() - start) / us;
}

void step_through_doors(benchmark::State& state) {
  Rendering cpp(kSphere);
  sf_rendering* c = nullptr;
  if (sf_rendering_create(kSphere.c_str(), nullptr, &c, nullptr, 0) != SF_DONE) {
    state.SkipWithError("the scene cannot be loaded");
    return;
  }
  RenderingSnapshot snapshot;
  std::vector<double> cpp_times, c_times;
  double time = 0.0, force = 0.0, c_force = 0.0;
  for (auto _ : state) {
    const double height = 27e-3 - 1.5e-3 * std::sin(2.0 * time);
    Pose X_WFt;
    X_WFt.translation.z() = height;
    const sf_pose pose = {sizeof(sf_pose), {0.0, 0.0, height}, {1.0, 0.0, 0.0, 0.0}};
    cpp_times.push_back(timed([&] {
      benchmark::DoNotOptimize(cpp.step(X_WFt, time));
      cpp.snapshot(snapshot);
    }));
    sf_contact contact = {sizeof(sf_contact)};
    c_times.push_back(timed([&] {
      sf_command command = {sizeof(sf_command)};
      sf_rendering_step(c, &pose, time, &command);
      sf_rendering_contact(c, &contact);
    }));
    force += snapshot.normal_force;
    c_force += contact.normal_force_N;
    time += 1e-3;
  }
  sf_rendering_destroy(c);
  if (!(force > 0.0) || force != c_force) state.SkipWithError("the two do not touch alike");
  const double by_cpp = median_of(cpp_times), by_c = median_of(c_times);
  state.counters["cpp_us"] = by_cpp;
  state.counters["c_us"] = by_c;
  state.counters["extra_us"] = by_c - by_cpp;
}
BENCHMARK(step_through_doors)
    ->Name("door/S_sphere")
    ->Iterations(6000)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace softfinger
