#include "softfinger/finger/strain_energy.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {
namespace {

class StrainEnergyOf : public ::testing::TestWithParam<const char*> {};

// Another way to the same number: the kernels that step the skin sum over elements, with warm
// rotations instead of a decomposition.
TEST_P(StrainEnergyOf, SumsUpToTheEnergyTheSkinIsSteppedWith) {
  const auto model = FingerModel::load(std::filesystem::path(SOFTFINGER_SOURCE_DIR) / "fingers" /
                                       (std::string(GetParam()) + ".toml"));
  FingerPotential potential(*model, FingerPotential::Bone::kPrescribed, 0, {});
  std::mt19937 random(3);
  std::normal_distribution<double> shift(0.0, 0.2e-3);
  std::vector<Vector3> positions = model->mesh.nodes;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    if (!model->node_is_rigid[n])
      positions[n] += Vector3(shift(random), shift(random), shift(random));
  }
  FingerPotential::Step step;
  step.old_positions = model->mesh.nodes;
  potential.begin(step);
  potential.start_from(positions, Pose{});

  const StrainEnergy energy(model);
  std::vector<double> densities(energy.elements());
  energy.densities(positions, densities);
  const double sum =
      std::inner_product(densities.begin(), densities.end(), energy.volumes().begin(), 0.0);
  EXPECT_NEAR(sum, potential.elastic_energy(), 1e-9 * sum);
  energy.densities(model->mesh.nodes, densities);
  for (const double density : densities) EXPECT_NEAR(density, 0.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Fingers, StrainEnergyOf, ::testing::Values("index", "index-layered"));

}  // namespace
}  // namespace softfinger
