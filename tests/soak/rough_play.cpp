#include "rough_play.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "../world/play.hpp"
#include "../world/soft_box.hpp"
#include "softfinger/geometry/mass_properties.hpp"
#include "violent_motion.hpp"

namespace softfinger {
namespace {

constexpr double kHands = 3.0;          ///< s with fingers, of each round
constexpr double kAlone = 2.0;          ///< s without them
constexpr double kDeepest = 1.0 * mm;   ///< into the table, under whatever presses
constexpr double kDeepestAlone = 1e-5;  ///< at the end, under its own weight
/// Of what is left alone, over the least energy that it had, in parts of what lifts it by
/// kDeepestAlone: as far as contacts give.
constexpr double kGain = 1.0;
constexpr double kUnconverged = 0.01;
const long kStepsOfRound = std::lround((kHands + kAlone) / kStep);
constexpr long kSaidEach = 20;  ///< rounds, after which it says how it went so far
constexpr double kSlow = 10.0;  ///< ms a step, that is said of a round

/// What was found in some rounds.
struct Roughness {
  long steps = 0, unconverged = 0, not_finite = 0, fallen = 0, rounds = 0, soft = 0;
  double depth = 0.0;        ///< m, the most while fingers play
  double depth_alone = 0.0;  ///< m, at the end of a round
  double gain = 0.0;         ///< see kGain
  double fastest = 0.0;      ///< m/s
  double force = 0.0;        ///< N, the most on a finger

  [[nodiscard]] bool is_sound() const {
    return not_finite == 0 && fallen == 0 && depth <= kDeepest && depth_alone <= kDeepestAlone &&
           gain <= kGain &&
           static_cast<double>(unconverged) <= kUnconverged * static_cast<double>(steps);
  }

  void add(const Roughness& other) {
    steps += other.steps;
    unconverged += other.unconverged;
    not_finite += other.not_finite;
    fallen += other.fallen;
    rounds += other.rounds;
    soft += other.soft;
    depth = std::max(depth, other.depth);
    depth_alone = std::max(depth_alone, other.depth_alone);
    gain = std::max(gain, other.gain);
    fastest = std::max(fastest, other.fastest);
    force = std::max(force, other.force);
  }
};

/// Numbers as any library draws them alike.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double between(double least, double most) {
    return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double between_logarithms(double least, double most) {
    return std::exp(between(std::log(least), std::log(most)));
  }
  Vector3 in_cube(double half) {
    const double x = between(-half, half);
    const double y = between(-half, half);
    const double z = between(-half, half);
    return {x, y, z};
  }
  std::uint64_t seed() { return random_(); }
  int below(int count) { return static_cast<int>(between(0.0, count)); }

 private:
  std::mt19937_64 random_;
};

struct Thing {
  VirtualObject object;
  double mass = 0.0;
  double least_height = 0.0;  ///< m, of its centre above the table, however it lies
};

Thing draw_thing(Draw& draw, int number) {
  Thing thing;
  thing.mass = draw.between_logarithms(1e-3, 0.5);
  const double size = draw.between(8.0, 20.0) * mm;
  Shape shape;
  switch (draw.below(3)) {
    case 0:
      shape = Ball{size};
      thing.least_height = size;
      break;
    case 1: {
      const Vector3 half(size, draw.between(6.0, 20.0) * mm, draw.between(6.0, 20.0) * mm);
      shape = RoundedBox{half, 1.0 * mm};
      thing.least_height = half.minCoeff();
      break;
    }
    default: {
      const double half_length = draw.between(6.0, 25.0) * mm;
      shape = RoundedCylinder{size, half_length, 1.0 * mm};
      thing.least_height = std::min(size, half_length);
    }
  }
  // Above each other, so that none begins in another.
  const Vector3 at(draw.between(-15.0, 15.0) * mm, draw.between(-15.0, 15.0) * mm,
                   (40.0 + 70.0 * number) * mm);
  thing.object = loose("thing", shape, at, thing.mass, draw.between(0.1, 1.0));
  thing.object.name += std::to_string(number);
  thing.object.motion = Trajectory(Pose{exp_rotation(draw.in_cube(2.0)), at});
  thing.object.dynamics->velocity_W = draw.in_cube(0.3);
  thing.object.dynamics->angular_velocity_W = draw.in_cube(10.0);
  return thing;
}

/// Kinetic and of height, J.
double energy_of(const Play& play, const std::vector<Thing>& things) {
  double sum = 0.0;
  for (std::size_t i = 0; i < things.size(); ++i) {
    const ObjectState& state = play.state(i + 1);
    const MassProperties even = *mass_properties(things[i].object.shape);
    const Matrix3 second = things[i].mass / even.volume * even.second_moment_O;
    const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
    const Vector3 spin = state.X_WO.rotation.transpose() * state.angular_velocity;
    sum += 0.5 * things[i].mass * state.velocity.squaredNorm() + 0.5 * spin.dot(inertia * spin) +
           things[i].mass * kGravity * state.X_WO.translation.z();
  }
  return sum;
}

void look(const Play& play, const std::vector<Thing>& things, Roughness& found) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    const ObjectState& state = play.state(i + 1);
    if (!state.X_WO.translation.allFinite() || !state.X_WO.rotation.allFinite() ||
        !state.velocity.allFinite() || !state.angular_velocity.allFinite()) {
      ++found.not_finite;
      continue;
    }
    found.fastest = std::max(found.fastest, state.velocity.norm());
    const double depth = things[i].least_height - state.X_WO.translation.z();
    found.depth = std::max(found.depth, depth);
    if (depth > things[i].least_height) ++found.fallen;
  }
}

Roughness play_round(std::uint64_t seed) {
  Draw draw(seed);
  Roughness found;
  std::vector<VirtualObject> objects{
      still("table", HalfSpace{}, Vector3::Zero(), draw.between(0.1, 1.0))};
  std::vector<Thing> things;
  const int count = 2 + draw.below(4);
  for (int i = 0; i < count; ++i) {
    things.push_back(draw_thing(draw, i));
    objects.push_back(things.back().object);
  }
  const bool soft = draw.below(4) == 0;
  if (soft) {
    objects.push_back(still("sponge", HalfSpace{}, Vector3(0.0, 50.0, 15.0) * mm));
    objects.back().soft = soft_box(Vector3(30, 30, 20) * mm, {3, 3, 2},
                                   draw.between_logarithms(5e3, 2e5), 0.3, 200.0);
  }
  std::vector<Play::Path> paths;
  for (const double side : {1.0, -1.0}) {
    // Around the things, and into the table.
    const Pose centre{exp_rotation(draw.in_cube(0.8)), Vector3(25.0 * side, 0.0, 15.0) * mm};
    auto motion =
        std::make_shared<ViolentMotion>(std::vector<Waypoint>{{0.0, centre}}, draw.seed());
    // As fast as a run takes a tracked pose for a hand's.
    auto limited = std::make_shared<Pose>(centre);
    paths.emplace_back([motion, limited](double time) {
      const Pose& wanted = motion->sample(time);
      const Vector3 way = wanted.translation - limited->translation;
      limited->translation += way * std::min(1.0, 1.0 * kStep / std::max(way.norm(), 1e-12));
      const Vector3 turn = log_rotation(wanted.rotation * limited->rotation.transpose());
      limited->rotation =
          exp_rotation(turn * std::min(1.0, 20.0 * kStep / std::max(turn.norm(), 1e-12))) *
          limited->rotation;
      return *limited;
    });
  }
  Play play(objects, kDown, paths);
  while (play.time() < kHands) {
    play.step();
    look(play, things, found);
    for (const std::size_t f : {0U, 1U}) {
      const double force = play.finger(f).contact().normal_force;
      if (!std::isfinite(force)) ++found.not_finite;
      found.force = std::max(found.force, force);
    }
  }
  play.leave();
  double least = 0.0;
  double lift = 0.0;
  for (const Thing& thing : things) lift += thing.mass * kGravity * kDeepestAlone;
  const int free_steps = static_cast<int>(kAlone / kStep);
  for (int k = 0; k < free_steps; ++k) {
    play.step();
    look(play, things, found);
    const double now = energy_of(play, things);
    // Something soft may push what lies on it as it springs back.
    least = k == 0 ? now : std::min(least, now);
    if (!soft) found.gain = std::max(found.gain, (now - least) / lift);
  }
  for (std::size_t i = 0; i < things.size(); ++i) {
    found.depth_alone = std::max(found.depth_alone,
                                 things[i].least_height - play.state(i + 1).X_WO.translation.z());
  }
  found.steps = std::lround(play.time() / kStep);
  found.unconverged = play.unconverged();
  found.soft = soft ? 1 : 0;
  found.rounds = 1;
  return found;
}

void say(const Roughness& found) {
  fmt::print(
      "rough play: {} rounds, {} with something soft, {} steps, {} unconverged, {} not finite, {} "
      "through the table\n"
      "  most: {:.1f} N on a finger, {:.1f} m/s, {:.3g} um into the table, {:.3g} um at rest; what "
      "was left alone gained {:.2g} of what lifts it by 10 um\n",
      found.rounds, found.soft, found.steps, found.unconverged, found.not_finite, found.fallen,
      found.force, found.fastest, 1e6 * found.depth, 1e6 * found.depth_alone, found.gain);
}

}  // namespace

bool play_roughly(long steps, std::uint64_t seed) {
  const long rounds = std::max(1L, (steps + kStepsOfRound - 1) / kStepsOfRound);
  Roughness all;
  bool sound = true;
  std::mutex shared;
  std::atomic<long> next = 0;
  const auto play_on = [&] {
    for (long round = next++; round < rounds; round = next++) {
      const std::uint64_t own = seed + static_cast<std::uint64_t>(round);
      const auto began = std::chrono::steady_clock::now();
      const Roughness found = play_round(own);
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - began;
      const std::scoped_lock lock(shared);
      all.add(found);
      const double step = took.count() / static_cast<double>(found.steps);
      if (!found.is_sound() || step > kSlow) {
        fmt::print("{}: --seed {} --steps {}, {:.1f} ms a step\n",
                   found.is_sound() ? "slow" : "NOT SOUND", own, found.steps, step);
        if (!found.is_sound()) say(found);
      }
      sound = sound && found.is_sound();
      if (all.rounds % kSaidEach == 0 && all.rounds < rounds) say(all);
      std::fflush(stdout);
    }
  };
  std::vector<std::future<void>> players(std::max(1U, std::thread::hardware_concurrency()));
  for (std::future<void>& player : players) player = std::async(std::launch::async, play_on);
  for (std::future<void>& player : players) player.get();
  say(all);
  return sound;
}

}  // namespace softfinger
