#include "softfinger/finger/element_loads.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>
#include <random>

#include "../support/folders.hpp"
#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {
namespace {

class ElementLoadsOf : public ::testing::TestWithParam<const char*> {
 protected:
  std::shared_ptr<const FingerModel> model = FingerModel::load(
      std::filesystem::path(source_folder()) / "fingers" / (std::string(GetParam()) + ".toml"));
  ElementLoads loads{model};

  /// Of every node, by `size` m; those of the bone stay.
  std::vector<Vector3> random_shift(unsigned seed, double size) {
    std::mt19937 random(seed);
    std::normal_distribution<double> shift(0.0, size);
    std::vector<Vector3> shifts(model->mesh.nodes.size(), Vector3::Zero());
    for (std::size_t n = 0; n < shifts.size(); ++n) {
      if (!model->node_is_rigid[n]) shifts[n] = {shift(random), shift(random), shift(random)};
    }
    return shifts;
  }
  std::vector<Vector3> moved(const std::vector<Vector3>& shifts, double factor) {
    std::vector<Vector3> positions = model->mesh.nodes;
    for (std::size_t n = 0; n < positions.size(); ++n) positions[n] += factor * shifts[n];
    return positions;
  }
  double energy(const std::vector<Vector3>& positions) {
    std::vector<double> densities(loads.size());
    loads.energy_densities(positions, densities);
    return std::inner_product(densities.begin(), densities.end(), loads.volumes().begin(), 0.0);
  }
  static Matrix3 tensor(const Stress& s) {
    Matrix3 t;
    t << s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2];
    return t;
  }
};

// Another way to the same number: the kernels that step the skin sum over elements, with warm
// rotations instead of a decomposition.
TEST_P(ElementLoadsOf, EnergiesSumUpToWhatTheSkinIsSteppedWith) {
  FingerPotential potential(*model, FingerPotential::Bone::kPrescribed, 0, {});
  const std::vector<Vector3> positions = moved(random_shift(3, 0.2e-3), 1.0);
  FingerPotential::Step step;
  step.old_positions = model->mesh.nodes;
  potential.begin(step);
  potential.start_from(positions, Pose{});
  const double sum = energy(positions);
  EXPECT_NEAR(sum, potential.elastic_energy(), 1e-9 * sum);
  EXPECT_NEAR(energy(model->mesh.nodes), 0.0, 1e-12 * sum);
}

// The work of the stresses on a small motion of the nodes is what the energy gains.
TEST_P(ElementLoadsOf, StressIsTheDerivativeOfEnergy) {
  const std::vector<Vector3> shifts = random_shift(3, 0.02e-3);  // nothing inside out
  const std::vector<Vector3> direction = random_shift(4, 1e-3);
  const std::vector<Vector3> positions = moved(shifts, 1.0);
  std::vector<Stress> stresses(loads.size());
  loads.stresses(positions, stresses);
  double work = 0.0;
  std::size_t e = 0;
  for (std::size_t t = 0; t < model->mesh.tetrahedra.size(); ++t) {
    const auto& nodes = model->mesh.tetrahedra[t];
    const bool rigid = std::all_of(nodes.begin(), nodes.end(), [&](int n) {
      return model->node_is_rigid[static_cast<std::size_t>(n)];
    });
    if (rigid || model->tetrahedron_material[t] < 0) continue;
    Matrix3 edges;
    Matrix3 rates;
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(nodes[static_cast<std::size_t>(k) + 1]);
      const auto b = static_cast<std::size_t>(nodes[0]);
      edges.col(k) = positions[a] - positions[b];
      rates.col(k) = direction[a] - direction[b];
    }
    const double volume = edges.determinant() / 6.0;
    work += volume * (tensor(stresses[e]).array() * (rates * edges.inverse()).array()).sum();
    ++e;
  }
  ASSERT_EQ(e, loads.size());
  constexpr double kStep = 1e-5;
  std::vector<Vector3> ahead = positions;
  std::vector<Vector3> behind = positions;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    ahead[n] += kStep * direction[n];
    behind[n] -= kStep * direction[n];
  }
  const double gained = (energy(ahead) - energy(behind)) / (2.0 * kStep);
  EXPECT_NEAR(work, gained, 1e-5 * std::abs(gained));
}

TEST_P(ElementLoadsOf, StressTurnsWithTheFinger) {
  const std::vector<Vector3> positions = moved(random_shift(5, 0.2e-3), 1.0);
  const Matrix3 turn = Pose{exp_rotation({0.4, -0.7, 1.1}), Vector3::Zero()}.rotation;
  std::vector<Vector3> turned = positions;
  for (Vector3& position : turned) position = turn * position;
  std::vector<Stress> before(loads.size());
  std::vector<Stress> after(loads.size());
  loads.stresses(positions, before);
  loads.stresses(turned, after);
  for (std::size_t e = 0; e < loads.size(); ++e) {
    const Matrix3 expected = turn * tensor(before[e]) * turn.transpose();
    EXPECT_LT((tensor(after[e]) - expected).norm(), 1e-8 * (1.0 + expected.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(Fingers, ElementLoadsOf, ::testing::Values("index", "index-layered"));

}  // namespace
}  // namespace softfinger
