// Force-aware matching in the shipped scenes: what one device tick costs where the finger touches,
// contact surface matching and all attempts of the twin together; thread CPU time.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../tests/support/folders.hpp"
#include "scenario.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/objectives/twin_correction.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr double kTick = 1.0 / 30.0;  // s

/// What the virtual finger touches at every tick of a scenario.
std::vector<ContactSet> contacts_of(const Scenario& scenario) {
  FingerSimulation finger(scenario.model, scenario.objects, scenario.time_step);
  finger.reset(scenario.path[0]);
  std::vector<ContactSet> contacts;
  for (std::size_t k = 1; k <= scenario.steps(); ++k) {
    const double time = static_cast<double>(k) * scenario.time_step;
    finger.step(scenario.path[k], time);
    if (time >= kTick * static_cast<double>(contacts.size())) contacts.push_back(finger.contact());
  }
  return contacts;
}

void force_aware(benchmark::State& state, const char* scene, const char* finger,
                 const char* device_name) {
  const Scenario scenario = scripted(scene, finger, 1e-3);
  const std::vector<ContactSet> contacts = contacts_of(scenario);
  const auto device = load_device(source_folder() + "/devices/" + device_name);
  std::vector<double> times;
  double iterations = 0.0;
  for ([[maybe_unused]] auto unused : state) {
    SurfaceFollowing surface(device, static_cast<int>(scenario.model->sample_nodes.size()));
    TwinCorrection force(scenario.model, device);
    for (const ContactSet& contact : contacts) {
      const double start = thread_cpu_time();
      const RenderedSurface& rendered =
          force.tick(contact, {}, surface.tick(contact, kTick), kTick);
      const double took = thread_cpu_time() - start;
      if (contact.contact_count == 0) continue;
      times.push_back(took / us);
      iterations += rendered.iterations;
    }
  }
  std::sort(times.begin(), times.end());
  state.counters["median_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
  state.counters["max_us"] = times.back();
  state.counters["iterations"] = iterations / static_cast<double>(times.size());
  state.counters["frames"] = static_cast<double>(times.size());
}
BENCHMARK_CAPTURE(force_aware, S_plane, "plane", "index", "thimble-3rrs.toml")->Iterations(3);
BENCHMARK_CAPTURE(force_aware, S_sphere, "sphere", "index", "thimble-3rrs.toml")->Iterations(3);
BENCHMARK_CAPTURE(force_aware, M_plane, "plane", "index-medium", "thimble-3rrs.toml")
    ->Iterations(3);
BENCHMARK_CAPTURE(force_aware, M_sphere, "sphere", "index-medium", "thimble-3rrs.toml")
    ->Iterations(3);
BENCHMARK_CAPTURE(force_aware, S_edge_36_pins, "edge", "index", "pins-wagner-6x6.toml")
    ->Iterations(1);

}  // namespace
}  // namespace softfinger
