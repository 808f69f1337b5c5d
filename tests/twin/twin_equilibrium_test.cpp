// What holds of every press, whatever the finger: a block of tissue under the thimble's disk.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "../support/box_finger.hpp"
#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> thimble() {
  static const std::shared_ptr<const Device> device =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  return device;
}

/// Pitch and roll in degrees; depth in mm from where the level disk first touches the block.
Configuration at(double pitch, double roll, double depth) {
  Configuration q(3);
  q << 0.0, 0.0, 0.0;
  const double touch = -7 * mm - thimble()->surface_pose(q).translation.z();
  q << pitch * deg, roll * deg, touch + depth * mm;
  return q;
}

/// The block, or what a mirror in the plane y = 0 makes of it.
std::shared_ptr<FingerModel> block(bool mirrored = false) {
  std::shared_ptr<FingerModel> model = testing_support::box_finger();
  if (!mirrored) return model;
  for (Vector3& node : model->mesh.nodes) node.y() = -node.y();
  for (auto& tetrahedron : model->mesh.tetrahedra) std::swap(tetrahedron[2], tetrahedron[3]);
  for (auto& triangle : model->mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& triangle : model->skin_triangles) std::swap(triangle[1], triangle[2]);
  return model;
}

/// Greatest force on a node of the skin or in it that nothing balances, N.
double unbalanced(const Twin& twin) {
  const FingerModel& model = twin.wearer();
  const FingerPotential potential(model, FingerPotential::Bone::kPrescribed, 1, {});
  const ElasticModel& elastic = potential.elastic();
  ElasticModel::Work work = elastic.make_work();
  std::vector<Vector3> residual(model.mesh.nodes.size(), Vector3::Zero());
  elastic.energy_gradient(twin.positions(), work, residual);
  const ContactSet& contact = twin.contact();
  for (std::size_t s = 0; s < contact.samples.size(); ++s) {
    const ContactSample& sample = contact.samples[s];
    residual[static_cast<std::size_t>(model.sample_nodes[s])] -=
        sample.normal_force_F + sample.tangential_force_F;
  }
  double greatest = 0.0;
  for (std::size_t n = 0; n < residual.size(); ++n) {
    if (!model.node_is_rigid[n]) greatest = std::max(greatest, residual[n].norm());
  }
  return greatest;
}

TEST(TwinEquilibrium, EveryNodeIsInBalance) {
  for (const double friction : {0.0, 0.5}) {
    Twin twin(block(), thimble());
    for (const Configuration& q : {at(0.0, 0.0, 0.6), at(4.0, -3.0, 1.0), at(-5.0, 2.0, 1.4)}) {
      ASSERT_TRUE(twin.press(q, friction, 0.0).converged);
      ASSERT_GT(twin.contact().normal_force, 0.1);
      EXPECT_LT(unbalanced(twin), 1e-5 * twin.contact().normal_force) << friction;
    }
  }
}

TEST(TwinEquilibrium, ForceGrowsAsTheTissueStiffens) {
  const auto force = [](double factor) {
    const std::shared_ptr<FingerModel> model = block();
    model->materials[0].youngs_modulus *= factor;
    model->strain_limits.stiffness *= factor;
    Twin twin(model, thimble());
    twin.press(at(3.0, 2.0, 1.0), 0.0, 0.0);
    return normal_force_vector(twin.contact());
  };
  const Vector3 one = force(1.0);
  for (const double factor : {0.5, 3.0}) {
    // Not quite, for the contact stays as stiff as it was.
    EXPECT_LT((force(factor) - factor * one).norm(), 0.01 * factor * one.norm()) << factor;
  }
}

TEST(TwinEquilibrium, AMirrorChangesTheSignOfWhatPointsAtIt) {
  Twin left(block(), thimble());
  Twin right(block(true), thimble());
  for (const auto& [pitch, roll] : {std::pair{0.0, 0.0}, {5.0, 4.0}, {-3.0, -6.0}}) {
    left.press(at(pitch, roll, 1.0), 0.5, 0.0);
    right.press(at(pitch, -roll, 1.0), 0.5, 0.0);
    const Vector3 force = normal_force_vector(left.contact());
    const Vector3 mirrored = normal_force_vector(right.contact());
    const Vector3 expected(force.x(), -force.y(), force.z());
    EXPECT_LT((mirrored - expected).norm(), 1e-3 * force.norm()) << pitch << ' ' << roll;
    EXPECT_EQ(right.contact().contact_count, left.contact().contact_count);
  }
}

TEST(TwinEquilibrium, WithoutContactThereIsNoForceAndNothingMoves) {
  Twin twin(block(), thimble());
  twin.press(at(2.0, -1.0, -0.5), 0.5, 0.0);
  EXPECT_EQ(twin.contact().contact_count, 0);
  EXPECT_EQ(twin.contact().normal_force, 0.0);
  EXPECT_GT(twin.contact().least_gap, 0.1 * mm);
  Vector3 force;
  SurfaceJacobian by_q;
  ASSERT_TRUE(twin.force_and_derivative(force, by_q));
  EXPECT_EQ(force, Vector3::Zero());
  EXPECT_EQ(by_q.norm(), 0.0);
  const std::vector<Vector3>& rest = twin.wearer().mesh.nodes;
  for (std::size_t n = 0; n < rest.size(); ++n) EXPECT_EQ(twin.positions()[n], rest[n]);
}

TEST(TwinEquilibrium, DeeperIsStrongerAndRoundTripsEndWhereTheyBegan) {
  const std::shared_ptr<FingerModel> model = block();
  model->feature_contact = false;  // which is seen from where the skin was
  Twin twin(model, thimble());
  double last = 0.0;
  for (const double depth : {0.3, 0.6, 0.9, 1.2}) {
    twin.press(at(0.0, 0.0, depth), 0.0, 0.0);
    EXPECT_GT(twin.contact().normal_force, last) << depth;
    last = twin.contact().normal_force;
  }
  for (const double depth : {1.6, -1.0, 1.2}) twin.press(at(0.0, 0.0, depth), 0.0, 0.0);
  EXPECT_NEAR(twin.contact().normal_force, last, 1e-5 * last);
}

}  // namespace
}  // namespace softfinger
