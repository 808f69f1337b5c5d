#include "motion_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "../world/play.hpp"
#include "../world/soft_box.hpp"
#include "softfinger/geometry/mass_properties.hpp"

namespace softfinger::validation {
namespace {

constexpr double kSettled = 1.5;  // s

/// Two fingers on both sides of what is `half_width` thick: pinch, lift by 20 mm, then as `moved`.
std::vector<Play::Path> pinch(double half_width, double depth, double height,
                              const std::function<double(double)>& moved) {
  std::vector<Play::Path> paths;
  for (const double sign : {1.0, -1.0}) {
    paths.push_back([=](double time) {
      const double x = half_width + kPad + 0.5 * mm - (depth + 0.5 * mm) * smooth(time, 0.0, 0.3);
      const double z = height + 20.0 * mm * smooth(time, 0.35, 0.7) + moved(time);
      return Pose{exp_rotation(Vector3(0.0, sign * 0.5 * std::numbers::pi, 0.0)),
                  Vector3(sign * x, 0.0, z)};
    });
  }
  return paths;
}

double still_there(double /*time*/) { return 0.0; }

/// Where the two fingers' pads are, on average.
Vector3 between(const Play& play) {
  return 0.5 * (play.finger(0).bone_pose().translation + play.finger(1).bone_pose().translation);
}

Play block_on_slope(double angle, double friction) {
  return Play({still("ground", HalfSpace{}, Vector3::Zero(), friction),
               loose("block", RoundedBox{Vector3(20, 20, 5) * mm, 0.5 * mm},
                     Vector3(0, 0, 5.0 * mm), 0.05, friction)},
              kGravity * Vector3(std::sin(angle), 0.0, -std::cos(angle)));
}

bool slides(double angle, double friction) {
  Play play = block_on_slope(angle, friction);
  play.run(0.5);
  const double start = play.state(1).X_WO.translation.x();
  play.run(1.0);
  return std::abs(play.state(1).X_WO.translation.x() - start) > 1e-6;
}

void count(const Play& play, MotionFigures& figures) {
  figures.unconverged += play.unconverged();
  figures.steps += std::lround(play.time() / kStep);
}

RoundedBox cube(double size) { return {Vector3::Constant(0.5 * size), 0.5 * mm}; }

/// A cube between two fingers: the heaviest that stays, and the lightest that does not.
void hold_at_the_limit(MotionFigures& figures) {
  constexpr double kFriction = 0.5;
  /// 2 mu N over its weight, or nothing where it slips.
  const auto margin = [&](double mass) {
    Play play({loose("cube", cube(30.0 * mm), Vector3::Zero(), mass, kFriction),
               still("ground", HalfSpace{}, Vector3(0.0, 0.0, -15.0 * mm), kFriction)},
              kDown, pinch(15.0 * mm, 2.0 * mm, 0.0, still_there));
    play.run(kSettled);
    const double settled = play.state(0).X_WO.translation.z();
    play.run(1.0);
    count(play, figures);
    const double force = 2.0 * kFriction * play.finger(0).contact().normal_force;
    const bool stays =
        settled > 10.0 * mm && std::abs(play.state(0).X_WO.translation.z() - settled) < 1e-6;
    return stays ? std::optional(force / (mass * kGravity)) : std::nullopt;
  };
  double held = 0.01;
  figures.hold_margin = *margin(held);
  double slips = 1.3 * figures.hold_margin * held;
  while (slips / held > 1.002) {
    const double middle = std::sqrt(slips * held);
    const std::optional<double> found = margin(middle);
    if (found) figures.hold_margin = *found;
    (found ? held : slips) = middle;
  }
}

void collide(MotionFigures& figures) {
  VirtualObject a = loose("a", Ball{8.0 * mm}, Vector3(-20.0 * mm, 0.0, 0.0), 0.03);
  a.dynamics->velocity_W = Vector3(0.5, 0.02, 0.0);
  Play play({a, loose("b", cube(20.0 * mm), Vector3(10.0 * mm, 5.0 * mm, 2.0 * mm), 0.05)},
            Vector3::Zero());
  const auto momentum = [&] {
    return Vector3(0.03 * play.state(0).velocity + 0.05 * play.state(1).velocity);
  };
  const Vector3 before = momentum();
  play.run(0.2);
  count(play, figures);
  figures.momentum_error = (momentum() - before).norm() / before.norm();
}

/// A closed system: five cubes that fly into each other, no gravity.
void gain_no_energy(MotionFigures& figures) {
  std::vector<VirtualObject> cubes;
  std::vector<double> masses;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 5.0;
    const Vector3 out(std::cos(angle), std::sin(angle), 0.1 * i);
    masses.push_back(0.02 + 0.02 * i);
    cubes.push_back(loose("cube", cube(20.0 * mm), 60.0 * mm * out, masses.back()));
    cubes.back().name += std::to_string(i);
    cubes.back().dynamics->velocity_W = -0.4 * out;
    cubes.back().dynamics->angular_velocity_W = Vector3(2.0, -1.0, 3.0) * (i + 1);
  }
  Play play(cubes, Vector3::Zero());
  const auto energy = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      const ObjectState& state = play.state(i);
      const MassProperties even = *mass_properties(cubes[i].shape);
      const Matrix3 second = masses[i] / even.volume * even.second_moment_O;
      const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
      const Vector3 spin = state.X_WO.rotation.transpose() * state.angular_velocity;
      sum += 0.5 * masses[i] * state.velocity.squaredNorm() + 0.5 * spin.dot(inertia * spin);
    }
    return sum;
  };
  play.step();
  const double first = energy();
  double before = first;
  while (play.time() < 2.0) {
    play.step();
    const double now = energy();
    figures.energy_gained = std::max(figures.energy_gained, now - before);
    before = now;
  }
  figures.energy_lost = first - before;
  count(play, figures);
}

void swing(MotionFigures& figures) {
  VirtualObject bob = loose("bob", Ball{5.0 * mm}, Vector3::Zero(), 0.05);
  const double length = kGravity / std::pow(2.0 * std::numbers::pi, 2);  // 1 Hz
  bob.dynamics->joint = Joint{
      .kind = JointKind::kHinge, .axis_O = Vector3::UnitY(), .point_O = Vector3(0.0, 0.0, length)};
  bob.dynamics->angular_velocity_W = Vector3(0.0, 0.5, 0.0);
  Play play({bob});
  const auto greatest = [&] {
    double most = 0.0;
    for (int k = 0; k < 1100; ++k) {
      play.step();
      most = std::max(most, std::abs(play.state(0).joint));
    }
    return most;
  };
  const double first = greatest();
  play.run(18.9);
  figures.pendulum_lost = (1.0 - greatest() / first) / 20.0;
  count(play, figures);
}

void rest(MotionFigures& figures) {
  for (const double mass : {1e-3, 0.05, 2.0}) {
    Play play({still("ground", HalfSpace{}),
               loose("cube", cube(30.0 * mm), Vector3(0, 0, 16.0 * mm), mass)});
    play.run(0.5);
    const double depth = 15.0 * mm - play.state(1).X_WO.translation.z();
    figures.rest_penetration = std::max(figures.rest_penetration, depth);
    count(play, figures);
  }
}

/// Pressed by a finger at 1 mm/s; the curve's top is 1.2 N at 1 mm.
void press_button(MotionFigures& figures) {
  VirtualObject button = loose("button", RoundedBox{Vector3(8, 8, 3) * mm, 0.5 * mm},
                               Vector3(0.0, 0.0, -3.0 * mm), 0.02);
  Joint joint{.kind = JointKind::kSlider};
  joint.limits = {-2.5 * mm, 0.0};
  joint.curve = {{0.0, 1.0 * mm, 1.4 * mm, 2.5 * mm}, {0.0, 1.2, 0.7, 2.5}};
  button.dynamics->joint = joint;
  const auto down = [](double time) {
    return Pose{Matrix3::Identity(), Vector3(0.0, 0.0, kPad + 0.1 * mm - 1.0 * mm * time)};
  };
  Play play({button}, Vector3::Zero(), {down});
  double before = 0.0;
  while (play.time() < 4.0) {
    play.step();
    const double force = play.finger(0).contact().normal_force;
    if (force > figures.button_force) {
      figures.button_force = force;
      figures.button_travel = -play.state(0).joint;
    }
    // The snap: it runs ahead of the finger.
    if (before - play.state(0).joint > 50e-6) break;
    before = play.state(0).joint;
  }
  count(play, figures);
}

void press_ever_stiffer(MotionFigures& figures) {
  const Vector3 size = Vector3(24, 24, 12) * mm;
  const Vector3 below(0.0, 0.0, -6.0 * mm);
  const auto press = [](double time) {
    return Pose{Matrix3::Identity(),
                Vector3(0.0, 0.0, kPad + 0.2 * mm - 1.7 * mm * smooth(time, 0.0, 0.2))};
  };
  Play rigid({still("box", RoundedBox{0.5 * size, 0.0}, below)}, kDown, {press});
  rigid.run(0.3);
  VirtualObject box = still("box", HalfSpace{}, below);
  box.soft = soft_box(size, {4, 4, 2}, 1e8, 0.3, 1000.0, true);
  Play soft({box}, kDown, {press});
  soft.run(0.3);
  count(soft, figures);
  const double wanted = rigid.finger(0).contact().normal_force;
  figures.stiff_soft_force = (soft.finger(0).contact().normal_force - wanted) / wanted;
}

}  // namespace

Drift held_capsule(const HeldCapsule& capsule, bool shaken) {
  const auto moved = [=](double time) {
    const double on = smooth(time, kSettled, kSettled + 0.5);
    return shaken ? 5.0 * mm * on * std::sin(4.0 * std::numbers::pi * time) : 0.0;
  };
  Play play({loose("capsule", RoundedCylinder{capsule.radius, capsule.half_length, capsule.radius},
                   Vector3(0.0, 0.0, capsule.half_length), capsule.mass, capsule.friction),
             still("ground", HalfSpace{}, Vector3::Zero(), capsule.friction)},
            kDown, pinch(capsule.radius, 2.0 * mm, capsule.half_length, moved));
  play.run(kSettled);
  const Vector3 settled = play.state(0).X_WO.translation - between(play);
  Drift found;
  found.force = play.finger(0).contact().normal_force;
  // Whole swings: where the fingers are in the same place as at the beginning.
  for (int second = 1; second <= static_cast<int>(capsule.duration); ++second) {
    play.run(1.0);
    found.drift.push_back((play.state(0).X_WO.translation - between(play) - settled).norm());
  }
  return found;
}

Incline incline() {
  Incline found;
  const double critical = std::atan(found.friction);
  double sticks = critical - 1.0 * deg;
  double slips = critical + 1.0 * deg;
  while (slips - sticks > 0.01 * deg) {
    const double middle = 0.5 * (sticks + slips);
    (slides(middle, found.friction) ? slips : sticks) = middle;
  }
  found.angle_error = 0.5 * (sticks + slips) - critical;
  const double steep = critical + 2.0 * deg;
  Play fast = block_on_slope(steep, found.friction);
  fast.run(0.5);
  const double speed = fast.state(1).velocity.x();
  fast.run(1.0);
  const double wanted = kGravity * (std::sin(steep) - found.friction * std::cos(steep));
  found.acceleration_error = (fast.state(1).velocity.x() - speed) / wanted - 1.0;
  Play slow = block_on_slope(critical - 0.5 * deg, found.friction);
  slow.run(0.5);
  const double start = slow.state(1).X_WO.translation.x();
  slow.run(10.0);
  found.creep = (slow.state(1).X_WO.translation.x() - start) / 10.0;
  return found;
}

MotionFigures motion_figures() {
  MotionFigures figures;
  hold_at_the_limit(figures);
  collide(figures);
  swing(figures);
  gain_no_energy(figures);
  rest(figures);
  press_button(figures);
  press_ever_stiffer(figures);
  return figures;
}

}  // namespace softfinger::validation
