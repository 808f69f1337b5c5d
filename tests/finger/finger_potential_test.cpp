#include "softfinger/finger/finger_potential.hpp"

#include <gtest/gtest.h>

#include "../support/box_finger.hpp"

namespace softfinger {
namespace {

using testing_support::box_finger;
using testing_support::displace;

/// A finger in the middle of everything: pressed, sliding, moving, off its tracked pose.
/// What the skin is made of.
struct Skin {
  const char* name;
  Dilatation dilatation;
  Relaxation relaxation;
};
const Skin kElastic{"elastic", Dilatation::kElement, {}};
const Skin kPatches{"patches", Dilatation::kPatch, {}};
const Skin kViscous{"viscous", Dilatation::kElement, {{{0.3, 4e-3}, {0.4, 70e-3}}}};
const Skin kViscousPatches{"viscous_patches", Dilatation::kPatch, {{{0.3, 4e-3}, {0.4, 70e-3}}}};

struct Busy {
  explicit Busy(const Skin& skin) : model(model_with(skin)) {
    ball = Ball{9e-3};
    obstacle.shape = &ball;
    obstacle.X_WO.translation = Vector3(1e-3, 0.5e-3, -15.6e-3);
    obstacle.friction_coefficient = 0.5;
    anchors = potential.contact().no_anchors();
    old_positions = model->mesh.nodes;
    displace(old_positions, 0.1e-3, 1);
    velocities.assign(old_positions.size(), Vector3::Zero());
    displace(velocities, 0.05, 2);
    for (FrictionAnchor& anchor : anchors) {
      anchor.anchor_O = Vector3(0.3e-3, 0.1e-3, 8.9e-3);
      anchor.normal_O = Vector3(0.1, -0.2, 0.9).normalized();
      anchor.limit = 0.01;
    }
    FingerPotential::Step step;
    step.time_step = 1e-3;
    step.old_positions = old_positions;
    step.velocities = velocities;
    step.old_bone.X_WF = {exp_rotation(Vector3(0.1, 0.05, -0.02)), Vector3(0.1, 0.2, 0.3) * 1e-3};
    step.old_bone.velocity = Vector3(0.01, -0.03, 0.02);
    step.old_bone.rotation_rate = skew(Vector3(1, 2, -1));
    step.X_WFt_old = {exp_rotation(Vector3(0.12, 0.0, 0.0)), Vector3::Zero()};
    step.X_WFt = {exp_rotation(Vector3(0.3, -0.2, 0.4)), Vector3(0.5, 0.0, -1.0) * 1e-3};
    step.obstacles = {&obstacle, 1};
    step.anchors = anchors;
    // Strained until now, and not relaxed yet.
    history = potential.elastic().make_history();
    potential.elastic().begin_step(history, 1e-3, work);
    std::vector<Vector3> ignored(old_positions.size(), Vector3::Zero());
    std::vector<Vector3> strained = model->mesh.nodes;
    displace(strained, 0.15e-3, 5);
    potential.elastic().energy_gradient(strained, work, ignored);
    potential.elastic().end_step(work, 1e-3, history);
    step.history = &history;
    potential.begin(step);
    potential.start_from(old_positions,
                         {exp_rotation(Vector3(0.05, 0.1, 0.2)), Vector3(0.2, -0.1, -0.6) * 1e-3});
  }

  static std::shared_ptr<FingerModel> model_with(const Skin& skin) {
    auto model = box_finger();
    model->dilatation = skin.dilatation;
    model->relaxation = skin.relaxation;
    return model;
  }

  std::shared_ptr<FingerModel> model;
  FingerPotential potential{*model, FingerPotential::Bone::kCoupled, 1, {}};
  Shape ball;
  Obstacle obstacle;
  std::vector<FrictionAnchor> anchors;
  std::vector<Vector3> old_positions, velocities;
  ElasticModel::Work work = potential.elastic().make_work();
  StressHistory history;
};

class EverySkin : public testing::TestWithParam<Skin> {};

/// Energy with unknown `index` moved by `step`.
double moved_energy(Busy& busy, std::size_t index, double step) {
  const UnknownMap& map = busy.potential.unknowns();
  std::vector<Vector3> x(busy.potential.positions().begin(), busy.potential.positions().end());
  const Pose X_WF = busy.potential.bone_pose();
  Pose moved = X_WF;
  const int block = static_cast<int>(index / 3);
  const Vector3 d = step * Vector3::Unit(static_cast<int>(index % 3));
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (map.block_of_node[n] == block) x[n] += d;
  }
  if (block == map.translation_block()) moved.translation += d;
  if (block == map.rotation_block()) moved.rotation = exp_rotation(d) * moved.rotation;
  const std::vector<Vector3> before(busy.potential.positions().begin(),
                                    busy.potential.positions().end());
  busy.potential.start_from(x, moved);
  const double energy = busy.potential.energy();
  busy.potential.start_from(before, X_WF);
  return energy;
}

TEST_P(EverySkin, GradientIsTheDerivativeOfTheEnergyForNodesAndBone) {
  Busy busy(GetParam());
  EXPECT_GT(busy.potential.contact().force_norm(), 0.01);
  const std::vector<double> g(busy.potential.gradient().begin(), busy.potential.gradient().end());
  double largest = 0.0;
  for (double v : g) largest = std::max(largest, std::abs(v));
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool is_rotation = i + 3 >= g.size();
    const double h = is_rotation ? 1e-6 : 1e-9;
    const double numeric = (moved_energy(busy, i, h) - moved_energy(busy, i, -h)) / (2 * h);
    EXPECT_NEAR(numeric, g[i], 1e-5 * largest * (is_rotation ? 8e-3 : 1.0)) << "unknown " << i;
  }
}

/// With the exact Hessian Newton converges quadratically; a wrong entry anywhere makes it linear.
/// Of remembered stress only the part along the axes of strain is in the Hessian.
TEST_P(EverySkin, NewtonConvergesQuadratically) {
  Busy busy(GetParam());
  NewtonOptions options;
  options.tolerance = 1e-12;
  options.chord_reduction = 1e300;
  const NewtonSummary all = minimise(busy.potential, options);
  ASSERT_TRUE(all.converged);
  Busy again(GetParam());
  std::vector<double> residuals;
  for (int i = 0; i <= all.iterations; ++i) {
    residuals.push_back(again.potential.residual());
    options.max_iterations = 1;
    again.potential.forget();
    minimise(again.potential, options);
  }
  // Of the last drop above rounding: r_{n+1} is of the order of r_n^2.
  bool quadratic = false;
  for (std::size_t i = 0; i + 1 < residuals.size(); ++i) {
    if (residuals[i] < 1e-2 && residuals[i] > 1e-8)
      quadratic |= residuals[i + 1] < 2e-3 * residuals[i];
  }
  EXPECT_TRUE(quadratic || !GetParam().relaxation.terms.empty());
  EXPECT_LE(all.iterations, 15);
}

TEST_P(EverySkin, SameStartGivesTheSameBits) {
  Busy a(GetParam());
  minimise(a.potential, NewtonOptions{});
  const std::vector<Vector3> first(a.potential.positions().begin(), a.potential.positions().end());
  Busy b(GetParam());
  minimise(b.potential, NewtonOptions{});
  for (std::size_t n = 0; n < first.size(); ++n) EXPECT_EQ(first[n], b.potential.positions()[n]);
}

INSTANTIATE_TEST_SUITE_P(FingerPotential, EverySkin,
                         testing::Values(kElastic, kPatches, kViscous, kViscousPatches),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace softfinger
