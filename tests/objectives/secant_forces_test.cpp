// What the search for forces learns from the forces it has felt.
#include "softfinger/objectives/secant_forces.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "../support/name_of_file.hpp"
#include "pressed_finger.hpp"

namespace softfinger {
namespace {

class EveryDevice : public testing::TestWithParam<const char*> {
 protected:
  EveryDevice() : device(device_of(GetParam())), dof(device->degrees_of_freedom()) {
    std::srand(1);  // Eigen draws from this
    secant.forces.normal = Vector3::Random();
    secant.forces.tangential = Vector3::Random();
    secant.forces.normal_by_q = SurfaceJacobian::Random(3, dof);
    secant.forces.tangential_by_q = SurfaceJacobian::Random(3, dof);
  }
  [[nodiscard]] double metric(int k) const {
    return device->axes()[static_cast<std::size_t>(k)].metric;
  }

  std::shared_ptr<const Device> device;
  int dof;
  SecantForces secant;
};

TEST_P(EveryDevice, ForetellsWhatItHasFelt) {
  const Configuration step = Configuration::Random(dof);
  const Vector3 normal = Vector3::Random();
  const Vector3 tangential = Vector3::Random();
  EXPECT_FALSE(secant.learn(*device, step, normal, tangential));
  EXPECT_TRUE(secant.doubtful);
  const TwinForces& forces = secant.forces;
  EXPECT_LT((forces.normal + forces.normal_by_q * step - normal).norm(), 1e-12);
  EXPECT_LT((forces.tangential + forces.tangential_by_q * step - tangential).norm(), 1e-12);
  secant.doubtful = false;
  EXPECT_TRUE(secant.learn(*device, step, normal, tangential)) << "it knows that by now";
  EXPECT_FALSE(secant.doubtful);
}

TEST_P(EveryDevice, LearnsNothingOfWhereItHasNotBeen) {
  ASSERT_GE(dof, 2);
  const Configuration step = Configuration::Random(dof);
  // At a right angle to the step, as the surface moves.
  Configuration aside = Configuration::Random(dof);
  double along = 0.0;
  double length = 0.0;
  for (int k = 0; k < dof; ++k) {
    along += metric(k) * metric(k) * step[k] * aside[k];
    length += metric(k) * metric(k) * step[k] * step[k];
  }
  aside -= along / length * step;
  const Vector3 before = secant.forces.normal_by_q * aside;
  secant.learn(*device, step, Vector3::Random(), Vector3::Random());
  EXPECT_LT((secant.forces.normal_by_q * aside - before).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Secant, EveryDevice,
                         testing::Values("thimble-3rrs", "plate-6dof", "pins-wagner-6x6",
                                         "strap-minamizawa", "delta-schorr"),
                         name_of_file<const char*>);

}  // namespace
}  // namespace softfinger
