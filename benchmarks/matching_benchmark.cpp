#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>
#include <vector>

#include "../tests/support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/kinds/pin_array.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/threads/thread_clock.hpp"

// Contact surface matching of 120 skin samples on the thimble; thread CPU time. The baseline is
// what Perez et al. 2015 did: MINPACK's Levenberg-Marquardt with finite differences, here as Eigen
// has it, on the same samples, its minimum checked against ours before either is timed.
namespace softfinger {
namespace {

std::shared_ptr<const Device> thimble() {
  static const std::shared_ptr<const Device> device =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  return device;
}

constexpr int kSamples = 120;

struct Frame {
  std::vector<Vector3> points;
  std::vector<std::uint8_t> in_contact;
  std::vector<double> gaps;

  [[nodiscard]] ContactPoints view() const { return {points, in_contact, {}, gaps}; }
};

/// A ball of 12 mm rolls over an ellipsoidal pad, up to `tilt` (rad) off its lowest point: frames
/// of one motion, each near the one before.
std::vector<Frame> rolling_ball(double tilt, int frames, int samples = kSamples) {
  constexpr double kRadius = 12.0 * mm;
  std::vector<Frame> motion;
  for (int f = 0; f < frames; ++f) {
    const double phase = 2.0 * std::numbers::pi * f / frames;
    const double angle = tilt * (0.6 + 0.4 * std::sin(3.0 * phase));
    const Vector3 normal(std::sin(angle) * std::cos(phase), std::sin(angle) * std::sin(phase),
                         std::cos(angle));
    Frame frame;
    for (int i = 0; i < samples; ++i) {
      const double azimuth = 2.39996323 * i;
      const double down = 1.0 - 0.95 * (i + 0.5) / samples;
      const double across = std::sqrt(1.0 - down * down);
      frame.points.emplace_back(12.5 * mm * across * std::cos(azimuth),
                                8.0 * mm * across * std::sin(azimuth), -7.3 * mm * down);
    }
    const Vector3 touch = *std::min_element(
        frame.points.begin(), frame.points.end(),
        [&](const Vector3& a, const Vector3& b) { return normal.dot(a) < normal.dot(b); });
    const Vector3 centre = touch + (1.5 * mm - kRadius) * normal;
    for (Vector3& p : frame.points) {
      const double gap = (p - centre).norm() - kRadius;
      frame.in_contact.push_back(gap <= 0.0 ? 1 : 0);
      frame.gaps.push_back(std::max(0.0, gap));
      if (gap < 0.0) p = centre + kRadius * (p - centre).normalized();
    }
    motion.push_back(std::move(frame));
  }
  return motion;
}

/// The residuals of E for MINPACK: three for each contact, one for each other sample.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  explicit Residuals(const Frame& the_frame) : frame(&the_frame) {
    for (const std::uint8_t c : frame->in_contact) count += c != 0 ? 3 : 1;
  }
  [[nodiscard]] int inputs() const { return 3; }
  [[nodiscard]] int values() const { return count; }
  int operator()(const Eigen::VectorXd& scaled, Eigen::VectorXd& residuals) const {
    Configuration q(3);
    for (int k = 0; k < 3; ++k) {
      q[k] = scaled[k] / thimble()->axes()[static_cast<std::size_t>(k)].metric * mm;
    }
    const Pose X_PF = thimble()->surface_pose(q).inverse();
    const double radius = thimble()->disk_radius();
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < frame->points.size(); ++i) {
      const Vector3 p = X_PF * frame->points[i] / mm;
      const double r = radius / mm;
      const double rho = std::hypot(p.x(), p.y());
      const double u = rho - r;
      if (frame->in_contact[i] != 0) {
        const double beyond = u > 0.0 ? 1.0 - r / rho : 0.0;
        residuals[row++] = beyond * p.x();
        residuals[row++] = beyond * p.y();
        residuals[row++] = p.z();
        continue;
      }
      const double flank = (u + p.z()) / std::numbers::sqrt2;
      double distance = 0.0;
      if (u <= 0.0 && p.z() >= 0.0) {
        distance = p.z();
      } else if (p.z() <= 0.0 && flank <= 0.0) {
        distance = std::max(p.z(), flank);
      } else {
        distance = p.z() > u ? std::hypot(u, p.z()) : flank;
      }
      residuals[row++] = std::min(0.0, distance - std::min(0.2, frame->gaps[i] / mm));
    }
    return 0;
  }

  const Frame* frame;
  int count = 0;
};

struct BaselineAnswer {
  Eigen::VectorXd scaled;  ///< mm of surface motion
  double deviation = 0.0;  ///< m^2
};

BaselineAnswer baseline(const Frame& frame, const Eigen::VectorXd& start) {
  Eigen::NumericalDiff<Residuals> residuals{Residuals(frame)};
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Residuals>> minimiser(residuals);
  BaselineAnswer answer{start, 0.0};
  minimiser.minimize(answer.scaled);
  answer.deviation = minimiser.fvec.squaredNorm() * mm2;
  return answer;
}

struct Motion {
  std::vector<Frame> frames;
  std::vector<Configuration> before;  ///< the answer of the frame before: warm start
};

/// Where MINPACK starts from q.
Eigen::VectorXd scaled(const Configuration& q) {
  Eigen::VectorXd start(3);
  for (int k = 0; k < 3; ++k) {
    start[k] = q[k] * thimble()->axes()[static_cast<std::size_t>(k)].metric / mm;
  }
  return start;
}

/// Frames for which both find the same minimum of E; the others are of no use for a race.
Motion motion_with_one_minimum(int samples, int count) {
  Motion chosen;
  const std::vector<Frame> frames = rolling_ball(15.0 * deg, count, samples);
  ContactSurfaceMatching matching(thimble(), samples);
  MatchingOptions options;
  options.limits = MatchingLimits::kNone;
  Configuration warm = matching.solve(frames.back().view(), options).configuration;
  for (const Frame& frame : frames) {
    const MatchingResult ours = matching.solve(frame.view(), options, &warm);
    const BaselineAnswer theirs = baseline(frame, scaled(warm));
    if (std::abs(theirs.deviation - ours.deviation) < 1e-3 * ours.deviation + 1e-14) {
      chosen.frames.push_back(frame);
      chosen.before.push_back(warm);
    }
    warm = ours.configuration;
  }
  return chosen;
}

const Motion& shared_motion() {
  static const Motion motion = motion_with_one_minimum(kSamples, 400);
  return motion;
}

/// Runs `solve(frame index)` over the motion and reports median and p99 of thread CPU time, us.
template <typename Solve>
void over_motion(benchmark::State& state, const Motion& motion, Solve&& solve) {
  std::vector<double> times;
  std::size_t f = 0;
  for ([[maybe_unused]] auto unused : state) {
    const auto start = thread_cpu_time();
    solve(f);
    times.push_back((thread_cpu_time() - start) / us);
    f = (f + 1) % motion.frames.size();
  }
  std::sort(times.begin(), times.end());
  state.counters["median_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
  state.counters["frames"] = static_cast<double>(motion.frames.size());
}

void matching(benchmark::State& state, MatchingLimits limits, bool warm, double tilt_deg) {
  Motion motion;
  if (tilt_deg == 0.0) {
    motion = shared_motion();
  } else {
    motion.frames = rolling_ball(tilt_deg * deg, 400);
    motion.before.assign(motion.frames.size(), thimble()->home());
  }
  ContactSurfaceMatching solver(thimble(), kSamples);
  MatchingOptions options;
  options.limits = limits;
  Configuration last = thimble()->home();
  double iterations = 0.0;
  double limited = 0.0;
  over_motion(state, motion, [&](std::size_t f) {
    const Configuration& start = tilt_deg == 0.0 ? motion.before[f] : last;
    const MatchingResult result =
        solver.solve(motion.frames[f].view(), options, warm ? &start : nullptr);
    last = result.configuration;
    iterations += result.iterations;
    limited += result.active_constraints.any() ? 1.0 : 0.0;
  });
  state.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["limited"] = benchmark::Counter(limited, benchmark::Counter::kAvgIterations);
}

void minpack(benchmark::State& state) {
  const Motion& motion = shared_motion();
  over_motion(state, motion, [&](std::size_t f) {
    benchmark::DoNotOptimize(baseline(motion.frames[f], scaled(motion.before[f])));
  });
}

/// Both on the same frames in the same run, an iteration once over the motion.
void race_minpack(benchmark::State& state, const Motion& motion, int samples) {
  if (motion.frames.empty()) {
    state.SkipWithError("no frame has one minimum for both");
    return;
  }
  ContactSurfaceMatching solver(thimble(), samples);
  MatchingOptions options;
  options.limits = MatchingLimits::kNone;
  std::vector<double> ours;
  std::vector<double> theirs;
  double iterations = 0.0;
  for ([[maybe_unused]] auto unused : state) {
    for (std::size_t f = 0; f < motion.frames.size(); ++f) {
      const double t0 = thread_cpu_time();
      benchmark::DoNotOptimize(baseline(motion.frames[f], scaled(motion.before[f])));
      const double t1 = thread_cpu_time();
      iterations += solver.solve(motion.frames[f].view(), options, &motion.before[f]).iterations;
      theirs.push_back(t1 - t0);
      ours.push_back(thread_cpu_time() - t1);
    }
  }
  std::sort(ours.begin(), ours.end());
  std::sort(theirs.begin(), theirs.end());
  const std::size_t count = ours.size();
  state.counters["samples"] = samples;
  state.counters["frames"] = static_cast<double>(motion.frames.size());
  state.counters["iterations"] = iterations / static_cast<double>(count);
  state.counters["median_us"] = ours[count / 2] / us;
  state.counters["p99_us"] = ours[count * 99 / 100] / us;
  state.counters["minpack_us"] = theirs[count / 2] / us;
  state.counters["minpack_p99_us"] = theirs[count * 99 / 100] / us;
  state.counters["ratio"] = theirs[count / 2] / ours[count / 2];
}

void ratio_to_minpack(benchmark::State& state) { race_minpack(state, shared_motion(), kSamples); }

void matching_samples(benchmark::State& state) {
  const auto samples = static_cast<int>(state.range(0));
  race_minpack(state, motion_with_one_minimum(samples, 100), samples);
}

/// Square arrays of pins, 2 mm apart to 10 x 10, closer beyond.
std::shared_ptr<const Device> square_of_pins(int rows) {
  const double pitch = std::min(2.0 * mm, 20.0 * mm / rows);
  const PinArrayGeometry geometry{rows, rows, pitch, 0.25 * pitch, 3.0 * mm, 0.0};
  DeviceSettings settings;
  settings.kind = "pin_array";
  settings.axes = PinDrives::axes_for(geometry);
  settings.X_FB.translation = Vector3(0.0, 0.0, -7.8 * mm);
  settings.home = Configuration::Zero(geometry.rows * geometry.columns);
  settings.retracted = settings.home;
  LinearDrives::set_joint_limits(settings, 50.0 * mm);
  return make_pin_array(std::move(settings), geometry);
}

/// Any device under the rolling ball, each frame from the last's answer or from none.
void match_rolling_ball(benchmark::State& state, const std::shared_ptr<const Device>& device,
                        int samples, bool warm) {
  Motion motion;
  motion.frames = rolling_ball(15.0 * deg, 400, samples);
  ContactSurfaceMatching solver(device, samples);
  Configuration last = device->home();
  double iterations = 0.0;
  over_motion(state, motion, [&](std::size_t f) {
    const MatchingResult result = solver.solve(motion.frames[f].view(), {}, warm ? &last : nullptr);
    last = result.configuration;
    iterations += result.iterations;
  });
  state.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["samples"] = samples;
  state.counters["degrees_of_freedom"] = device->degrees_of_freedom();
}

void matching_pins(benchmark::State& state) {
  match_rolling_ball(state, square_of_pins(static_cast<int>(state.range(0))), kSamples,
                     state.range(1) != 0);
}

void matching_pins_samples(benchmark::State& state) {
  match_rolling_ball(state, square_of_pins(10), static_cast<int>(state.range(0)), true);
}

void matching_device(benchmark::State& state, const char* name) {
  match_rolling_ball(state, load_device(source_folder() + "/devices/" + name + ".toml"), kSamples,
                     true);
}

std::vector<Configuration> poses() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> tilt(-25.0, 25.0);
  std::uniform_real_distribution<double> travel(-3.0, 8.0);
  std::vector<Configuration> drawn;
  while (drawn.size() < 256) {
    Configuration q(3);
    q << tilt(random) * deg, tilt(random) * deg, travel(random) * mm;
    if (thimble()->reachable(q)) drawn.push_back(q);
  }
  return drawn;
}

void inverse_kinematics(benchmark::State& state) {
  const std::vector<Configuration> drawn = poses();
  JointAngles joints;
  std::size_t i = 0;
  for ([[maybe_unused]] auto unused : state) {
    benchmark::DoNotOptimize(thimble()->inverse_kinematics(drawn[i], joints));
    i = (i + 1) % drawn.size();
  }
}

void forward_kinematics(benchmark::State& state) {
  std::vector<JointAngles> joints;
  for (const Configuration& q : poses()) {
    JointAngles angles;
    if (thimble()->inverse_kinematics(q, angles)) joints.push_back(angles);
  }
  Configuration q;
  std::size_t i = 0;
  for ([[maybe_unused]] auto unused : state) {
    benchmark::DoNotOptimize(thimble()->forward_kinematics(joints[i], q));
    i = (i + 1) % joints.size();
  }
}

BENCHMARK_CAPTURE(matching, warm_inside, MatchingLimits::kInside, true, 0.0);
BENCHMARK_CAPTURE(matching, cold_inside, MatchingLimits::kInside, false, 0.0);
BENCHMARK_CAPTURE(matching, warm_none, MatchingLimits::kNone, true, 0.0);
BENCHMARK_CAPTURE(matching, warm_inside_at_limits, MatchingLimits::kInside, true, 40.0);
BENCHMARK_CAPTURE(matching, cold_inside_at_limits, MatchingLimits::kInside, false, 40.0);
BENCHMARK(minpack);
BENCHMARK(ratio_to_minpack)->Iterations(3);
BENCHMARK(matching_samples)->ArgsProduct({{120, 300, 1000, 3000, 10000}})->Iterations(5);
BENCHMARK(matching_pins)
    ->ArgNames({"rows", "warm"})
    ->ArgsProduct({{2, 3, 4, 6, 8, 10, 12, 16}, {0, 1}})
    ->Iterations(1200);
BENCHMARK(matching_pins_samples)->ArgsProduct({{120, 300, 1000, 3000, 10000}})->Iterations(400);
BENCHMARK_CAPTURE(matching_device, thimble, "thimble-3rrs")->Iterations(1200);
BENCHMARK_CAPTURE(matching_device, plate, "plate-6dof")->Iterations(400);
BENCHMARK(inverse_kinematics);
BENCHMARK(forward_kinematics);

}  // namespace
}  // namespace softfinger
