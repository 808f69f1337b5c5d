#include "recovery.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/minimise_in_cone.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

constexpr double kScramble = 5.0 * mm;
constexpr double kPressed = 0.5 * mm;
constexpr double kSame = 1e-3 * mm;
constexpr double kDeep = 4.0 * mm;

bool all_finite(std::span<const Vector3> positions) {
  return std::ranges::all_of(positions, [](const Vector3& x) { return x.allFinite(); });
}

long inverted_elements(const FingerModel& model, std::span<const Vector3> positions) {
  long count = 0;
  for (const auto& nodes : model.mesh.tetrahedra) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return positions[static_cast<std::size_t>(nodes[k])];
    };
    const double volume = (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0));
    if (!(volume > 0.0)) ++count;
  }
  return count;
}

double lowest(std::span<const Vector3> positions) {
  double z = positions[0].z();
  for (const Vector3& x : positions) z = std::min(z, x.z());
  return z;
}

}  // namespace

bool Recovery::sound() const {
  return unconverged == 0 && not_finite == 0 && inverted == 0 && apart < kSame;
}

Recovery scramble(const FingerModel& model, int trials, std::uint64_t seed) {
  const Shape plate = HalfSpace{};
  Obstacle obstacle;
  obstacle.shape = &plate;
  obstacle.X_WO.translation.z() = lowest(model.mesh.nodes) + kPressed;
  FingerPotential potential(model, FingerPotential::Bone::kPrescribed, 1, {});
  std::vector<FrictionAnchor> anchors = potential.contact().no_anchors();
  FingerPotential::Step step;
  step.old_positions = model.mesh.nodes;
  step.obstacles = {&obstacle, 1};
  step.anchors = anchors;
  NewtonOptions options;
  options.tolerance = 1e-9;
  options.max_iterations = 300;
  const auto settle = [&](std::span<const Vector3> from) {
    potential.forget();
    potential.begin(step);
    potential.start_from(from, Pose{});
    return untangle_and_minimise(potential, options);
  };

  (void)settle(model.mesh.nodes);
  const std::vector<Vector3> rest(potential.positions().begin(), potential.positions().end());
  Recovery recovery;
  std::mt19937_64 random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<Vector3> scrambled = model.mesh.nodes;
    for (Vector3& x : scrambled) {
      for (int axis = 0; axis < 3; ++axis) {
        x[axis] += kScramble * (static_cast<double>(random() >> 11) * 0x1p-52 - 1.0);
      }
    }
    const NewtonSummary summary = settle(scrambled);
    ++recovery.trials;
    if (!summary.converged) ++recovery.unconverged;
    if (!all_finite(potential.positions())) ++recovery.not_finite;
    recovery.inverted += inverted_elements(model, potential.positions());
    recovery.iterations = std::max(recovery.iterations, summary.iterations);
    for (std::size_t n = 0; n < rest.size(); ++n) {
      recovery.apart = std::max(recovery.apart, (potential.positions()[n] - rest[n]).norm());
    }
  }
  return recovery;
}

Recovery press_hard(const FingerModel& model) {
  Recovery recovery;
  for (const Indenter& indenter :
       {Indenter::plane(), Indenter::ball(8.0 * mm, 0.0, 0.0), Indenter::edge(1.0 * mm)}) {
    IndentationOptions options;
    options.depth = kDeep;
    options.rows = 40;
    options.friction = false;  // so that the way back ends where the way began
    options.unload = true;
    ++recovery.trials;
    std::vector<Vector3> last;
    indent(model, indenter, options, [&](const IndentationState& state) {
      if (!state.row.converged) ++recovery.unconverged;
      if (!all_finite(state.positions)) ++recovery.not_finite;
      recovery.inverted += inverted_elements(model, state.positions);
      recovery.iterations = std::max(recovery.iterations, state.row.iterations);
      recovery.max_force = std::max(recovery.max_force, state.row.normal_force);
      last.clear();
      for (const Vector3& x : state.positions) last.push_back(state.X_WF.inverse() * x);
    });
    for (std::size_t n = 0; n < last.size(); ++n) {
      recovery.apart = std::max(recovery.apart, (last[n] - model.mesh.nodes[n]).norm());
    }
  }
  return recovery;
}

}  // namespace softfinger
