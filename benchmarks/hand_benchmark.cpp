// Five fingers of the shipped hand, one tick of the simulation shared by two threads: CPU time of
// the busier thread, which is what a tick takes where each has a processor of its own.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scenario.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

constexpr int kHandThreads = 2;

class TimedHand {
 public:
  explicit TimedHand(const std::vector<Scenario>& scenarios) : scenarios_(scenarios) {
    for (const Scenario& scenario : scenarios_) {
      fingers_.push_back(
          std::make_unique<FingerSimulation>(scenario.model, scenario.objects, scenario.time_step));
    }
  }

  void tick() {
    if (at_ == scenarios_[0].steps()) at_ = 0;
    if (at_ == 0) {
      for (std::size_t i = 0; i < fingers_.size(); ++i) fingers_[i]->reset(scenarios_[i].path[0]);
    }
    ++at_;
    std::array<double, kHandThreads> busy{};
    const double wall_start = monotonic_time();
    team_.run(fingers_.size(), [&](std::size_t i, int thread) {
      const double start = thread_cpu_time();
      fingers_[i]->step(scenarios_[i].path[at_],
                        static_cast<double>(at_) * scenarios_[i].time_step);
      busy[static_cast<std::size_t>(thread)] += thread_cpu_time() - start;
    });
    wall_.push_back((monotonic_time() - wall_start) / us);
    busier_.push_back(std::max(busy[0], busy[1]) / us);
    both_.push_back((busy[0] + busy[1]) / us);
  }

  void report(benchmark::State& state) {
    tell(state, "", busier_);
    tell(state, "both_", both_);
    tell(state, "wall_", wall_);
  }

 private:
  static void tell(benchmark::State& state, const std::string& name, std::vector<double>& times) {
    std::ranges::sort(times);
    const auto at = [&](double q) {
      return times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))];
    };
    state.counters[name + "median_us"] = at(0.5);
    state.counters[name + "p99_us"] = at(0.99);
    state.counters[name + "p999_us"] = at(0.999);
    state.counters[name + "max_us"] = at(1.0);
  }

  const std::vector<Scenario>& scenarios_;
  std::vector<std::unique_ptr<FingerSimulation>> fingers_;
  ThreadTeam team_{kHandThreads};
  std::size_t at_ = 0;
  std::vector<double> busier_, both_, wall_;
};

void hand(benchmark::State& state) {
  const std::vector<Scenario> scenarios = shipped_hand(1e-3);
  TimedHand timed(scenarios);
  for ([[maybe_unused]] auto unused : state) timed.tick();
  timed.report(state);
}
BENCHMARK(hand)->Name("hand/five_fingers_two_threads")->Iterations(60000);

}  // namespace
}  // namespace softfinger
