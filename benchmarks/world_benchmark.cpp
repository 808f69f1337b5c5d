// Steps of objects that move by the forces on them, with fingers and without, on one thread: CPU
// time and Newton's iterations of each step of shipped scenes, and how the time grows with bodies,
// points that touch, and soft tetrahedra.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "world/play.hpp"
#include "world/soft_box.hpp"
#include "world_scene.hpp"

namespace softfinger {
namespace {

/// CPU time and iterations, step by step.
class Series {
 public:
  template <typename Step>
  void add(const World& world, const Step& step) {
    const double start = thread_cpu_time();
    step();
    times_.push_back((thread_cpu_time() - start) / us);
    iterations_.push_back(world.summary().iterations);
  }
  void report(benchmark::State& state) {
    const auto mean = [](const std::vector<double>& values) {
      return std::accumulate(values.begin(), values.end(), 0.0) /
             static_cast<double>(values.size());
    };
    state.counters["mean_us"] = mean(times_);
    state.counters["iterations"] = mean(iterations_);
    for (const auto& [values, prefix, unit] :
         {std::tuple(&times_, "", "_us"), std::tuple(&iterations_, "iterations_", "")}) {
      std::ranges::sort(*values);
      const auto at = [v = values](double q) {
        return (*v)[static_cast<std::size_t>(q * static_cast<double>(v->size() - 1))];
      };
      state.counters[std::string(prefix) + "median" + unit] = at(0.5);
      state.counters[std::string(prefix) + "p99" + unit] = at(0.99);
      state.counters[std::string(prefix) + "max" + unit] = at(1.0);
    }
  }

 private:
  std::vector<double> times_, iterations_;
};

void scene(benchmark::State& state, const std::string& name) {
  WorldScene shipped = WorldScene::shipped(name);
  Series series;
  for ([[maybe_unused]] auto unused : state) {
    series.add(shipped.world(), [&] { shipped.step(); });
  }
  series.report(state);
}
BENCHMARK_CAPTURE(scene, bottle, "bottle")->Name("world/bottle")->Iterations(6000);
BENCHMARK_CAPTURE(scene, handover, "handover")->Name("world/handover")->Iterations(6000);
BENCHMARK_CAPTURE(scene, cup, "cup")->Name("world/cup")->Iterations(6000);
BENCHMARK_CAPTURE(scene, tower, "tower")->Name("world/tower")->Iterations(6000);
BENCHMARK_CAPTURE(scene, sponge, "sponge")->Name("world/sponge")->Iterations(6000);

constexpr double kHalf = 10.0 * mm;
/// On a slope that everything slides down, so that nothing comes to rest.
const Vector3 kDownhill(kGravity* std::sin(0.2), 0.0, -kGravity* std::cos(0.2));
constexpr double kSlippery = 0.1;

VirtualObject block(const Vector3& half, const Vector3& at, double friction = kSlippery) {
  return loose("block", RoundedBox{half, 0.5 * mm}, at, 0.02, friction);
}

/// Blocks on a plane, `way` from middle to middle.
std::vector<VirtualObject> blocks(long count, double way, double friction = kSlippery) {
  std::vector<VirtualObject> objects{still("ground", HalfSpace{}, Vector3::Zero(), friction)};
  for (long i = 0; i < count; ++i) {
    objects.push_back(block(Vector3::Constant(kHalf),
                            Vector3(way * static_cast<double>(i), 0.0, kHalf), friction));
  }
  return objects;
}

void run(benchmark::State& state, Play& play) {
  Series series;
  for ([[maybe_unused]] auto unused : state) {
    series.add(play.world(), [&] { play.step(); });
  }
  series.report(state);
  state.counters["points"] = static_cast<double>(play.world().work().near);
}

/// Each by itself; in a row, each pushing the next, one island; at rest.
void apart(benchmark::State& state) {
  Play play(blocks(state.range(0), 10.0 * kHalf), kDownhill);
  play.run(0.1);
  run(state, play);
}
void in_a_row(benchmark::State& state) {
  Play play(blocks(state.range(0), 2.0 * kHalf), kDownhill);
  play.run(0.1);
  run(state, play);
}
void asleep(benchmark::State& state) {
  Play play(blocks(state.range(0), 2.0 * kHalf, 0.5));
  play.run(1.5);
  if (play.world().work().sleeping != static_cast<std::size_t>(state.range(0))) {
    state.SkipWithError("they do not sleep");
    return;
  }
  run(state, play);
}
BENCHMARK(apart)->Name("world_bodies/apart")->RangeMultiplier(2)->Range(1, 64)->Iterations(1000);
BENCHMARK(in_a_row)->Name("world_bodies/row")->RangeMultiplier(2)->Range(1, 64)->Iterations(1000);
BENCHMARK(asleep)->Name("world_bodies/asleep")->RangeMultiplier(2)->Range(1, 64)->Iterations(1000);

/// A plate that slides over so many knobs, which touch it with a point each.
void contacts(benchmark::State& state) {
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(state.range(0)))));
  const double way = 4.0 * mm;
  const Vector3 half(0.5 * way * side, 0.5 * way * side, 3.0 * mm);
  std::vector<VirtualObject> objects{block(half, Vector3(0.0, 0.0, half.z()))};
  // More of them downhill, for as far as the plate comes.
  for (int i = 0; i < 4 * side + 100; ++i) {
    for (int j = 0; j < side; ++j) {
      const double x = way * (i - 0.5 * (side - 1));
      const double y = way * (j - 0.5 * (side - 1));
      objects.push_back(still("knob", Ball{1.5 * mm}, Vector3(x, y, -1.5 * mm), kSlippery));
    }
  }
  Play play(objects, kDownhill);
  play.run(0.02);
  run(state, play);
}
BENCHMARK(contacts)->Name("world_contacts")->Arg(4)->Arg(16)->Arg(64)->Arg(256)->Iterations(300);

/// A finger presses a soft block, which is held below, and rubs it.
void tetrahedra(benchmark::State& state) {
  const auto cells = static_cast<int>(state.range(0));
  const auto solid = soft_box(Vector3(40, 40, 20) * mm, {cells, cells, std::max(1, cells / 2)},
                              20e3, 0.3, 200.0, true);
  const auto press = [](double time) {
    const double x = 3.0 * mm * std::sin(6.0 * time);
    const double z = kPad + 10.0 * mm - 2.5 * mm * smooth(time, 0.0, 0.3);
    return Pose{Matrix3::Identity(), Vector3(x, 0.0, z)};
  };
  Play play({soft("block", solid, Vector3::Zero())}, kDown, {press});
  run(state, play);
  state.counters["tetrahedra"] = static_cast<double>(solid->mesh.tetrahedra.size());
}
BENCHMARK(tetrahedra)->Name("world_tetrahedra")->DenseRange(2, 10, 2)->Iterations(1500);

}  // namespace
}  // namespace softfinger
