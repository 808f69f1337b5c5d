// The kernels, made of another law than tissue follows, the worked example of docs/extending.md:
// whoever writes one needs its file alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>

#include "constitutive_law/green_law.hpp"
#include "softfinger/fem/double_arithmetic.hpp"
#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE second_law
#include "softfinger/fem/element_kernels.inl"
#undef SOFTFINGER_KERNEL_NAMESPACE

namespace softfinger {
namespace {

constexpr double kMu = 15e3, kLambda = 40e3, kPressure = 3e3;

/// Psi and its derivatives hang together, for doubles.
template <template <typename> typename Law>
void expect_derivatives_agree() {
  using Plain = Law<DoubleArithmetic>;
  const double stretches[][3] = {
      {1.0, 1.0, 1.0}, {1.3, 0.7, 0.9}, {0.6, 0.6, 1.2}, {1.4, 0.8, -0.2}};
  for (const auto& s : stretches) {
    const Plain law(kMu, kLambda, s, Plain::dilatation(s), kPressure);
    EXPECT_NEAR(law.energy(),
                law.energy_of_dilatation() + law.energy_along(0) + law.energy_along(1) +
                    law.energy_along(2),
                1e-12 * (1.0 + law.energy()));
    const auto moved = [&](int i, double by) {
      double t[3] = {s[0], s[1], s[2]};
      t[i] += by;
      return Plain(kMu, kLambda, t, Plain::dilatation(t), kPressure);
    };
    const auto pressed = [](const Plain& at, int i) {
      return at.stress(i) + kPressure * at.dilatation_slope(i);
    };
    constexpr double kStep = 1e-6;
    constexpr double kScale = 1e-8 * kLambda;
    for (int j = 0; j < 3; ++j) {
      const Plain above = moved(j, kStep);
      const Plain below = moved(j, -kStep);
      EXPECT_NEAR((above.energy() - below.energy()) / (2 * kStep), law.stress(j), kScale);
      double t[3] = {s[0], s[1], s[2]};
      t[j] += kStep;
      const double upper = Plain::dilatation(t);
      t[j] -= 2 * kStep;
      EXPECT_NEAR((upper - Plain::dilatation(t)) / (2 * kStep), law.dilatation_slope(j), 1e-8);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR((pressed(above, i) - pressed(below, i)) / (2 * kStep), law.stiffness(i, j),
                    10.0 * kScale);
        if (i == j) continue;
        const double apart = s[i] - s[j];
        const double flip = apart == 0.0 ? law.stiffness(i, i) - law.stiffness(i, j)
                                         : (pressed(law, i) - pressed(law, j)) / apart;
        EXPECT_NEAR(law.flip(i, j), flip, 1e-9 * kLambda);
      }
    }
  }
}

TEST(ConstitutiveLaw, DerivativesAreThoseOfTheEnergy) {
  expect_derivatives_agree<ConstitutiveLaw>();
  expect_derivatives_agree<GreenLaw>();
}

/// Eight tetrahedra side by side, each with nodes of its own.
struct Elements {
  Elements() {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      for (std::size_t a = 0; a < 4; ++a) group.nodes[a][lane] = static_cast<int>(4 * lane + a);
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < 3; ++k) {
          group.shape[a][k][lane] = (a == k ? 1e3 : 0.0) + 100.0 * normal(random);
        }
        for (std::size_t k = 0; k < 3; ++k) {
          positions[3 * (4 * lane + a + 1) + k] = (a == k ? 1e-3 : 0.0) + 0.15e-3 * normal(random);
        }
      }
      group.volume[lane] = 1e-9;
      group.mu[lane] = kMu;
      group.lambda[lane] = kLambda;
      for (std::size_t i = 0; i < 3; ++i) {
        decomposition.v[4 * i][lane] = 1.0;
        decomposition.u[4 * i][lane] = 1.0F;
      }
    }
  }
  /// Of all, J: with kPressure on what patches would average.
  double evaluate(const ElementKernels& kernels) {
    const double energy =
        kernels.energy_gradient(group, limit, {}, positions, &decomposition, &forces, &dilatation);
    double pressed = 0.0;
    for (const double value : dilatation.value) pressed += kPressure * value;
    return energy + pressed;
  }
  [[nodiscard]] double force(std::size_t a, std::size_t k, std::size_t lane) const {
    return forces.force[a][k][lane] + kPressure * dilatation.force[a][k][lane];
  }

  ElementGroup group{};
  StrainLimit limit{0.35, 1.5, 40e3, 0.5};
  double positions[3 * 4 * kLaneCount] = {};
  ElementDecomposition decomposition{};
  ElementForces forces{};
  ElementDilatation dilatation{};
};

template <template <typename> typename Law>
void expect_kernels_follow() {
  const ElementKernels kernels = second_law::kernels_of<Law>();
  Elements elements;
  elements.evaluate(kernels);
  Elements moved = elements;
  ElementHessians hessians;
  alignas(64) double pressures[kLaneCount];
  std::fill(std::begin(pressures), std::end(pressures), kPressure);
  kernels.hessian(elements.group, 1.0, elements.decomposition, pressures, false, false, &hessians);
  constexpr double kStep = 1e-8;  // m
  constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    double greatest = 0.0;  // stiffness, N/m: that of strain limits, where one is reached
    for (const auto& block : hessians.block) {
      for (const auto& entry : block) {
        greatest = std::max(greatest, std::abs(static_cast<double>(entry[lane])));
      }
    }
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t k = 0; k < 3; ++k) {
        double& x = moved.positions[3 * (4 * lane + b) + k];
        const double at = x;
        x = at + kStep;
        const double energy_above = moved.evaluate(kernels);
        const Elements above = moved;
        x = at - kStep;
        const double energy_below = moved.evaluate(kernels);
        x = at;
        EXPECT_NEAR((energy_above - energy_below) / (2 * kStep), elements.force(b, k, lane),
                    1e-9 * greatest);
        for (std::size_t a = 0; a < 4; ++a) {
          for (std::size_t i = 0; i < 3; ++i) {
            // Block (a, b) for a <= b, else the transpose of (b, a); column-major.
            const std::size_t entry = a <= b ? 3 * k + i : 3 * i + k;
            EXPECT_NEAR((above.force(a, i, lane) - moved.force(a, i, lane)) / (2 * kStep),
                        hessians.block[kPlace[a][b]][entry][lane], 1e-6 * greatest);
          }
        }
      }
    }
  }
}

TEST(ElementKernels, FollowWhicheverLawTheyAreMadeOf) {
  expect_kernels_follow<ConstitutiveLaw>();
  expect_kernels_follow<GreenLaw>();
}

TEST(ElementKernels, AreOfTheLawNamed) {
  const ElementKernels named = second_law::kernels_of<ConstitutiveLaw>();
  Elements by_name, by_set, by_other;
  const double energy = by_name.evaluate(named);
  EXPECT_NEAR(by_set.evaluate(element_kernels(InstructionSet::kBaseline)), energy, 1e-12 * energy);
  EXPECT_GT(std::abs(by_other.evaluate(second_law::kernels_of<GreenLaw>()) - energy),
            1e-3 * energy);
}

}  // namespace
}  // namespace softfinger
