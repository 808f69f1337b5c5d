// The two ways to press a finger: `press`, whose bone is where it is told, and a run, whose bone
// follows through the coupling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger::relations {
namespace {

/// Couplings so stiff that the bone is where the tracker is.
std::shared_ptr<FingerModel> with_stiff_coupling(const FingerModel& model) {
  auto stiff = std::make_shared<FingerModel>(model);
  stiff->coupling.translation_stiffness *= 3e3;
  stiff->coupling.translation_damping *= 1e2;
  stiff->coupling.rotation_stiffness *= 1e4;
  stiff->coupling.rotation_damping *= 1e3;
  stiff->friction_coefficient = 0.0;
  stiff->relaxation = {};
  return stiff;
}

VirtualObject obstacle(const Indenter& indenter) {
  VirtualObject object;
  object.shape = indenter.shape;
  object.motion = Trajectory(Pose{Matrix3::Identity(), indenter.p_FO_W});
  object.friction_coefficient = 0.0;
  return object;
}

struct Pressed {
  double height = 0.0;  ///< of the bone's origin, m
  double normal_force = 0.0;
};

Pressed pressed(const FingerModel& model, const Indenter& indenter, double depth, double pitch) {
  Pressed end;
  indent(model, indenter, {.depth = depth, .rows = 12, .pitch = pitch, .friction = false},
         [&](const IndentationState& state) {
           end = {state.X_WF.translation.z(), state.row.normal_force};
         });
  return end;
}

constexpr double kTouch = 2e-6;  // m

// At rest, with the bone in the same place, nothing differs but the way there. Depth counts from
// the touch of the skin's surface, which both find by themselves; a stiff coupling gives way by a
// tenth of a micrometre.
void expect_alike(const Indenter& indenter, const char* name, Draw& draw, double tolerance,
                  bool features = true) {
  std::string what;
  const auto model = with_stiff_coupling(*draw_finger(draw, what));
  model->feature_contact = features;
  what += std::string(", ") + name;
  const double pitch = draw.between(0.0, 20.0) * deg;
  const double depth = draw.between(0.4, 1.5) * mm;
  Exploration exploration;
  exploration.what = what;
  exploration.model = model;
  exploration.objects.push_back(obstacle(indenter));
  const Pose touch = touching(*model, exploration.objects.front(), exp_rotation({0.0, pitch, 0.0}));
  Pose above = touch, below = touch;
  above.translation.z() += 0.5 * mm;
  below.translation.z() -= depth;
  exploration.motion = Trajectory({{0.0, above}, {0.3, below}, {0.6, below}});
  const Moment last = explore(exploration).last();
  // To where the run's bone is: the two look for the touch each in its own way.
  Pressed press = pressed(*model, indenter, depth, pitch);
  const double lower = press.height - last.X_WF.translation.z();
  EXPECT_NEAR(lower, 0.0, kTouch) << what << ": they touch at other heights";
  press = pressed(*model, indenter, depth + lower, pitch);
  ASSERT_GT(press.normal_force, 0.01) << what;
  EXPECT_NEAR(press.height, last.X_WF.translation.z(), 1e-9);
  EXPECT_NEAR(last.normal_force, press.normal_force, tolerance * press.normal_force)
      << what << " " << depth / mm << " mm deep, " << pitch / deg << " degrees";
}

// Of samples alone; and where a point inside a triangle, which goes part of the way to the deepest
// place in a step, rests a little beside it.
constexpr double kPressedSamples = 1e-3;
constexpr double kPressedFeatures = 0.03;

TEST(Press, AgainstARunOnAPlane) {
  for (int number = 0; number < cases(3); ++number) {
    Draw draw("press", number);
    expect_alike(Indenter::plane(), "plane", draw, kPressedSamples);
  }
}

/// Depth (m) and force (N), deeper and deeper.
using PressCurve = std::vector<std::pair<double, double>>;

/// What the way down to this depth took, J; 0 where the curve does not reach it.
double work_to(const PressCurve& curve, double depth) {
  double work = 0.0;
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const auto& [from, least] = curve[k - 1];
    const auto& [to, most] = curve[k];
    if (to >= depth * (1.0 - 1e-9)) {
      const double part = (depth - from) / (to - from);
      return work + (depth - from) * (least + 0.5 * part * (most - least));
    }
    work += 0.5 * (least + most) * (to - from);
  }
  return 0.0;
}

// By the work it takes: a fast touch rings from step to step.
// Tissue that moves has inertia: both step it alike, and the run comes from so far away that what
// its start shook has come to rest.
TEST(Press, AtSpeedAgainstARunOnAPlane) {
  constexpr double kRate = 20000.0;
  for (int number = 0; number < cases(3); ++number) {
    Draw draw("press at speed", number);
    std::string what;
    const auto model = with_stiff_coupling(*draw_finger(draw, what));
    const double pitch = draw.between(0.0, 20.0) * deg;
    const double speed = std::exp(draw.between(std::log(0.02), std::log(0.5)));
    const double depth = draw.between(0.1, 0.8) * mm;
    Exploration exploration;
    exploration.model = model;
    exploration.objects.push_back(obstacle(Indenter::plane()));
    exploration.rate = kRate;
    const Pose touch =
        touching(*model, exploration.objects.front(), exp_rotation({0.0, pitch, 0.0}));
    const double from = std::max(2.0 * mm, 0.3 * speed);
    constexpr int kPieces = 16;
    std::vector<Waypoint> waypoints;
    for (int k = 0; k <= kPieces; ++k) {
      const double gone = (from + depth) * k / kPieces;
      Pose pose = touch;
      pose.translation.z() += from - gone;
      waypoints.push_back({gone / speed, pose});
    }
    // Goes on at this speed where it is compared.
    Pose beyond = touch;
    beyond.translation.z() += from - (from + depth) * (kPieces + 1) / kPieces;
    waypoints.push_back({(from + depth) * (kPieces + 1) / kPieces / speed, beyond});
    exploration.motion = Trajectory(waypoints);
    PressCurve run;
    static_cast<void>(explore(exploration, [&](const FingerSimulation&, const Moment& moment) {
      run.emplace_back(touch.translation.z() - moment.X_WF.translation.z(), moment.force_W.z());
    }));
    const int rows = static_cast<int>(depth / speed * kRate) + 1;
    PressCurve press{{0.0, 0.0}};
    indent(*model, Indenter::plane(),
           {.depth = depth, .rows = rows, .pitch = pitch, .friction = false, .speed = speed},
           [&](const IndentationState& state) {
             press.emplace_back(state.row.indentation, state.row.normal_force);
           });
    const double whole = work_to(press, depth);
    ASSERT_GT(whole, 1e-7) << what;
    for (const double part : {0.25, 0.5, 1.0}) {
      EXPECT_NEAR(work_to(run, part * depth), work_to(press, part * depth),
                  (speed < 0.1 ? 5e-3 : 0.1) * whole)
          << what << ", " << part * depth / mm << " mm deep at " << speed << " m/s";
    }
  }
}

TEST(Press, AgainstARunOnABallAndAnEdge) {
  for (int number = 0; number < cases(3); ++number) {
    Draw draw("press", number);
    const double at_x = draw.between(-1.0, 1.0) * mm;
    const double at_y = draw.between(-1.0, 1.0) * mm;
    const Indenter ball = Indenter::ball(draw.between(5.0, 20.0) * mm, at_x, at_y);
    const Indenter edge = Indenter::edge(draw.between(0.2, 2.0) * mm);
    for (const bool features : {true, false}) {
      expect_alike(ball, "ball", draw, features ? kPressedFeatures : kPressedSamples, features);
      expect_alike(edge, "edge", draw, features ? kPressedFeatures : kPressedSamples, features);
    }
  }
}

}  // namespace
}  // namespace softfinger::relations
