#include "softfinger/fem/elastic_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "../support/box_mesh.hpp"
#include "softfinger/fem/stiffness_assembly.hpp"

namespace softfinger {
namespace {

using testing_support::box_mesh;
using testing_support::displace;

constexpr StrainLimit kLimit{0.35, 1.5, 40e3, 0.5};

struct Block {
  explicit Block(StrainLimit limit = kLimit, double nu = 0.4,
                 InstructionSet set = active_instruction_set(),
                 Dilatation dilatation = Dilatation::kElement, Relaxation relaxation = {})
      : mesh(box_mesh(2, 3, 2, Vector3(-1, -1, -1) * 1e-3, Vector3(2, 3, 2) * 1e-3)),
        tied(mesh.nodes.size(), false),
        model(mesh, std::vector<ElasticMaterial>{{45e3, nu, 1000.0}},
              std::vector<int>(mesh.tetrahedra.size(), 0), tied, limit, dilatation,
              std::move(relaxation), set),
        work(model.make_work()) {}

  double energy(const std::vector<Vector3>& x) {
    std::vector<Vector3> ignored(x.size(), Vector3::Zero());
    return model.energy_gradient(x, work, ignored);
  }
  std::vector<Vector3> gradient(const std::vector<Vector3>& x) {
    std::vector<Vector3> g(x.size(), Vector3::Zero());
    model.energy_gradient(x, work, g);
    return g;
  }

  TetrahedralMesh mesh;
  std::vector<bool> tied;
  ElasticModel model;
  ElasticModel::Work work;
};

double greatest(const std::vector<Vector3>& v) {
  double m = 0.0;
  for (const Vector3& a : v) m = std::max(m, a.norm());
  return m;
}

/// By central differences, at x.
void expect_hessian_is_derivative(Block& block, const std::vector<Vector3>& x) {
  const auto size = static_cast<Eigen::Index>(3 * x.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
  block.gradient(x);
  constexpr int kPairs[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1},
                                 {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};
  for (std::size_t e = 0; e < block.model.elements(); ++e) {
    ElementHessians h;
    const ElementGroup& group = block.model.groups()[e / kLanes];
    block.model.hessian(e / kLanes, block.work, false, h);
    for (int k = 0; k < 10; ++k) {
      const int a = group.nodes[kPairs[k][0]][e % kLanes];
      const int b = group.nodes[kPairs[k][1]][e % kLanes];
      Matrix3 m;
      for (int i = 0; i < 9; ++i) m.data()[i] = h.block[k][i][e % kLanes];
      hessian.block<3, 3>(3 * a, 3 * b) += m;
      if (a != b) hessian.block<3, 3>(3 * b, 3 * a) += m.transpose();
    }
  }
  EXPECT_LT((hessian - hessian.transpose()).norm(), 1e-6 * hessian.norm());
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-8;
      auto low = x;
      auto high = x;
      low[n][k] -= h;
      high[n][k] += h;
      const auto gl = block.gradient(low);
      const auto gh = block.gradient(high);
      for (std::size_t m = 0; m < x.size(); ++m) {
        const Vector3 numeric = (gh[m] - gl[m]) / (2 * h);
        const Vector3 exact = hessian.block<3, 1>(static_cast<Eigen::Index>(3 * m),
                                                  static_cast<Eigen::Index>(3 * n) + k);
        EXPECT_LT((numeric - exact).norm(), 1e-5 * hessian.cwiseAbs().maxCoeff());
      }
    }
  }
}

class EveryInstructionSet : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > best_instruction_set()) GTEST_SKIP() << "this processor lacks it";
  }
};

TEST_P(EveryInstructionSet, GradientIsTheDerivativeOfTheEnergy) {
  for (const Dilatation dilatation : {Dilatation::kElement, Dilatation::kPatch}) {
    Block block(kLimit, 0.4, GetParam(), dilatation);
    auto x = block.mesh.nodes;
    displace(x, 0.25e-3, 1);
    const auto g = block.gradient(x);
    const double scale = greatest(g);
    for (std::size_t n = 0; n < x.size(); ++n) {
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-8;
        auto low = x;
        auto high = x;
        low[n][k] -= h;
        high[n][k] += h;
        EXPECT_NEAR((block.energy(high) - block.energy(low)) / (2 * h), g[n][k], 2e-6 * scale);
      }
    }
  }
}

TEST_P(EveryInstructionSet, HessianIsTheDerivativeOfTheGradient) {
  Block block(kLimit, 0.4, GetParam());
  auto x = block.mesh.nodes;
  displace(x, 0.25e-3, 2);
  expect_hessian_is_derivative(block, x);
}

TEST_P(EveryInstructionSet, HessianKnowsTheStressRemembered) {
  const Relaxation relaxation{{{0.8, 4e-3}, {0.15, 70e-3}}};
  for (const double elapsed : {1e-3, 33e-3}) {
    Block block(kLimit, 0.4, GetParam(), Dilatation::kElement, relaxation);
    StressHistory history = block.model.make_history();
    auto x = block.mesh.nodes;
    for (Vector3& p : x) p = p.cwiseProduct(Vector3(1.2, 0.9, 0.7));
    displace(x, 0.2e-3, 6);
    for (int step = 0; step < 3; ++step) {  // held, so that it is remembered
      block.model.begin_step(history, 50e-3, block.work);
      block.energy(x);
      block.model.end_step(block.work, 50e-3, history);
    }
    block.model.begin_step(history, elapsed, block.work);
    auto back = block.mesh.nodes;
    displace(back, 0.25e-3, 7);
    const auto g = block.gradient(back);
    const std::size_t n = x.size() / 2;
    const double h = 1e-8;
    auto low = back;
    auto high = back;
    low[n][1] -= h;
    high[n][1] += h;
    EXPECT_NEAR((block.energy(high) - block.energy(low)) / (2 * h), g[n][1], 2e-6 * greatest(g));
    expect_hessian_is_derivative(block, back);
  }
}

TEST_P(EveryInstructionSet, RotationAndTranslationChangeNothingButTheFrame) {
  Block block(kLimit, 0.4, GetParam());
  auto x = block.mesh.nodes;
  displace(x, 0.3e-3, 3);
  const double energy = block.energy(x);
  const auto g = block.gradient(x);
  const Pose motion{exp_rotation(Vector3(0.7, -2.0, 1.1)), Vector3(0.03, -0.02, 0.01)};
  auto moved = x;
  for (Vector3& p : moved) p = motion * p;
  EXPECT_NEAR(block.energy(moved), energy, 1e-12 * energy);
  const auto turned = block.gradient(moved);
  for (std::size_t n = 0; n < g.size(); ++n) {
    EXPECT_LT((turned[n] - motion.rotation * g[n]).norm(), 1e-11 * greatest(g));
  }
}

TEST_P(EveryInstructionSet, InternalForcesHaveNoNetForceAndNoNetTorque) {
  Block block(kLimit, 0.4, GetParam());
  auto x = block.mesh.nodes;
  displace(x, 0.3e-3, 4);
  const auto g = block.gradient(x);
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
  for (std::size_t n = 0; n < g.size(); ++n) {
    force += g[n];
    torque += x[n].cross(g[n]);
  }
  EXPECT_LT(force.norm(), 1e-10 * greatest(g));
  EXPECT_LT(torque.norm(), 1e-10 * greatest(g) * 3e-3);
}

TEST_P(EveryInstructionSet, FlattenedAndInvertedElementsStayFinite) {
  Block block(kLimit, 0.4, GetParam());
  for (const Vector3& scale : {Vector3(1, 1, 0), Vector3(1, 0, 0), Vector3(0, 0, 0),
                               Vector3(1, 1, -1), Vector3(-1, -1, -1)}) {
    auto x = block.mesh.nodes;
    for (Vector3& p : x) p = p.cwiseProduct(scale);
    EXPECT_TRUE(std::isfinite(block.energy(x)));
    for (const Vector3& g : block.gradient(x)) EXPECT_TRUE(g.allFinite());
    ElementHessians h;
    block.model.hessian(0, block.work, true, h);
    for (const auto& b : h.block) {
      for (const auto& e : b) EXPECT_TRUE(std::isfinite(e[0]));
    }
  }
}

TEST_P(EveryInstructionSet, ProjectedElementHessiansArePositiveSemidefinite) {
  Block block(kLimit, 0.4, GetParam());
  auto x = block.mesh.nodes;
  for (Vector3& p : x) p *= 0.6;
  displace(x, 0.3e-3, 5);
  block.gradient(x);
  for (std::size_t g = 0; g < block.model.groups().size(); ++g) {
    ElementHessians h;
    block.model.hessian(g, block.work, true, h);
    Eigen::MatrixXd full(12, 12);
    int k = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = a; b < 4; ++b, ++k) {
        Matrix3 m;
        for (int i = 0; i < 9; ++i) m.data()[i] = h.block[k][i][0];
        full.block<3, 3>(3 * a, 3 * b) = m;
        full.block<3, 3>(3 * b, 3 * a) = m.transpose();
      }
    }
    // No eigenvalue below -1e-6 of the largest, which is no less than any entry on the diagonal.
    full.diagonal().array() += 1e-6 * full.diagonal().maxCoeff();
    EXPECT_EQ(full.llt().info(), Eigen::Success);
  }
}

INSTANTIATE_TEST_SUITE_P(ElasticModel, EveryInstructionSet,
                         testing::Values(InstructionSet::kBaseline, InstructionSet::kAvx2,
                                         InstructionSet::kAvx512),
                         [](const auto& set) { return std::string(name_of(set.param)); });

TEST(ElasticModel, RestIsFreeOfEnergyAndForce) {
  Block block;
  EXPECT_NEAR(block.energy(block.mesh.nodes), 0.0, 1e-25);
  EXPECT_LT(greatest(block.gradient(block.mesh.nodes)), 1e-12);
}

TEST(ElasticModel, UniformStretchHasTheEnergyOfTheFormula) {
  Block block(StrainLimit{}, 0.4);
  auto x = block.mesh.nodes;
  const Vector3 s(1.1, 0.95, 1.03);
  for (Vector3& p : x) p = p.cwiseProduct(s);
  // mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu)(1 - 2 nu)), by hand for E 45 kPa, nu 0.4
  const double mu = 16071.428571428571;
  const double lambda = 64285.714285714286;
  const double density =
      mu * (0.01 + 0.0025 + 0.0009) + 0.5 * lambda * std::pow(0.1 - 0.05 + 0.03, 2);
  EXPECT_NEAR(block.energy(x), density * 12e-9, 1e-12 * density);
}

TEST(ElasticModel, MassesSumToTheMassOfTheTissue) {
  Block block;
  double mass = 0.0;
  for (double m : block.model.masses()) mass += m;
  EXPECT_NEAR(mass, 1000.0 * 12e-9, 1e-18);
}

/// Newton on the interior nodes alone, boundary prescribed.
TEST(ElasticModel, PatchTestKeepsAnAffineMap) {
  for (const auto& [strain, dilatation] :
       {std::pair(0.01, Dilatation::kElement), std::pair(0.2, Dilatation::kElement),
        std::pair(0.2, Dilatation::kPatch)}) {
    TetrahedralMesh mesh = box_mesh(3, 3, 3, Vector3::Zero(), Vector3::Constant(3e-3));
    std::vector<bool> boundary(mesh.nodes.size(), false);
    for (const auto& t : mesh.triangles) {
      for (int n : t) boundary[static_cast<std::size_t>(n)] = true;
    }
    ElasticModel model(mesh, std::vector<ElasticMaterial>{{45e3, 0.4, 1000.0}},
                       std::vector<int>(mesh.tetrahedra.size(), 0), boundary, kLimit, dilatation,
                       Relaxation{}, active_instruction_set());
    const UnknownMap map = make_unknown_map(boundary, false);
    ASSERT_EQ(map.free_blocks, 8);
    StiffnessAssembly assembly(model, map, active_instruction_set());
    Matrix3 affine = Matrix3::Identity();
    affine(0, 0) += strain;
    affine(0, 1) += 0.5 * strain;
    affine(2, 2) -= 0.3 * strain;
    affine = exp_rotation(Vector3(0.4, 0.2, -0.9)) * affine;
    std::vector<Vector3> exact;
    for (const Vector3& X : mesh.nodes) exact.push_back(affine * X);
    auto x = exact;
    auto moved = x;
    displace(moved, 0.15e-3, 9);
    for (std::size_t n = 0; n < x.size(); ++n) {
      if (!boundary[n]) x[n] = moved[n];
    }
    auto work = model.make_work();
    const std::vector<Vector3> arms(x.size(), Vector3::Zero());
    for (int iteration = 0; iteration < 20; ++iteration) {
      std::vector<Vector3> g(x.size(), Vector3::Zero());
      model.energy_gradient(x, work, g);
      assembly.clear(arms);
      assembly.add_elastic(model, work, false);
      ASSERT_TRUE(assembly.factor());
      std::vector<double> d(static_cast<std::size_t>(3 * map.blocks()));
      for (std::size_t n = 0; n < x.size(); ++n) {
        if (map.block_of_node[n] < 0) continue;
        for (int k = 0; k < 3; ++k) {
          d[static_cast<std::size_t>(3 * map.block_of_node[n] + k)] = -g[n][k];
        }
      }
      assembly.solve(d);
      for (std::size_t n = 0; n < x.size(); ++n) {
        if (map.block_of_node[n] < 0) continue;
        x[n] += Eigen::Map<const Vector3>(d.data() + 3 * map.block_of_node[n]);
      }
    }
    for (std::size_t n = 0; n < x.size(); ++n) EXPECT_LT((x[n] - exact[n]).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
