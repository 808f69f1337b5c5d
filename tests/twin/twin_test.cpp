#include "softfinger/twin/twin.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kHere = source_folder();

std::shared_ptr<const FingerModel> wearer(const std::string& name = "index") {
  return FingerModel::load(kHere / "fingers" / (name + ".toml"));
}

std::shared_ptr<const Device> thimble_under_test() {
  return load_device(kHere / "devices" / "thimble-3rrs.toml");
}

Configuration level(double travel) {
  Configuration q(3);
  q << 0.0, 0.0, travel;
  return q;
}

/// Travel at which the level disk first touches the resting skin.
double touching_travel(const Device& device, const FingerModel& model) {
  double lowest = 0.0;
  for (const int node : model.sample_nodes) {
    lowest = std::min(lowest, model.mesh.nodes[static_cast<std::size_t>(node)].z());
  }
  return lowest - device.surface_pose(level(0.0)).translation.z();
}

// The disk is flat and wider than the contact: to the pad it is the plane of a press.
TEST(Twin, FeelsALevelDiskAsThePlaneOfAPress) {
  const auto model = wearer();
  const auto device = thimble_under_test();
  Twin twin(model, device);
  const double touch = touching_travel(*device, *model);
  std::vector<IndentationRow> rows;
  IndentationOptions options;
  options.depth = 0.75 * mm;  // deeper, the contact is longer than the disk
  options.rows = 3;
  options.friction = false;
  indent(*model, Indenter::plane(), options,
         [&](const IndentationState& state) { rows.push_back(state.row); });
  for (const IndentationRow& row : rows) {
    EXPECT_TRUE(twin.press(level(touch + row.indentation), 0.0, 0.0).converged);
    EXPECT_NEAR(twin.contact().normal_force, row.normal_force, 1e-4 * row.normal_force);
    EXPECT_EQ(twin.contact().contact_count, row.contact_samples);
    EXPECT_NEAR(twin.contact().mean_normal_F.z(), 1.0, 1e-9);
  }
}

/// The finger without contact between its samples, which is seen from where the skin was.
std::shared_ptr<FingerModel> plain_wearer() {
  auto model = std::make_shared<FingerModel>(*wearer());
  model->feature_contact = false;
  return model;
}

TEST(Twin, FrictionlessContactDoesNotKnowTheWay) {
  const auto model = plain_wearer();
  const auto device = thimble_under_test();
  Twin straight(model, device);
  Twin roundabout(model, device);
  const double touch = touching_travel(*device, *model);
  Configuration q(3);
  q << 3.0 * deg, -2.0 * deg, touch + 0.7 * mm;
  straight.press(q, 0.0, 0.0);
  // Not over the rim: skin that slips off it may stay there.
  for (const double pitch : {-4.0, 0.0, 5.0}) {
    Configuration stop(3);
    stop << pitch * deg, 3.0 * deg, touch + 1.0 * mm;
    roundabout.press(stop, 0.0, 0.0);
  }
  roundabout.press(q, 0.0, 0.0);
  EXPECT_GT(straight.contact().normal_force, 0.1);
  EXPECT_NEAR(roundabout.contact().normal_force, straight.contact().normal_force,
              1e-4 * straight.contact().normal_force);
}

// The implicit function theorem against pressing again nearby.
TEST(Twin, ForceDerivativeIsThatOfTheEquilibrium) {
  const auto model = plain_wearer();
  const auto device = thimble_under_test();
  const double touch = touching_travel(*device, *model);
  for (const auto& [pitch, roll, depth] :
       {std::array{0.0, 0.0, 0.8}, std::array{7.0, -4.0, 1.3}, std::array{-9.0, 6.0, 1.8}}) {
    Twin twin(model, device);
    Configuration q(3);
    q << pitch * deg, roll * deg, touch + depth * mm;
    twin.press(q, 0.0, 0.0);
    Vector3 force;
    SurfaceJacobian by_q;
    ASSERT_TRUE(twin.force_and_derivative(force, by_q));
    EXPECT_LT((force - normal_force_vector(twin.contact())).norm(), 1e-6);
    for (int k = 0; k < 3; ++k) {
      // Short enough that no sample comes or goes.
      const double h = 2e-7 / device->axes()[static_cast<std::size_t>(k)].metric;
      const auto force_at = [&](double offset) {
        Configuration near = q;
        near[k] += offset;
        twin.begin_frame(0.0, 0.0);
        twin.attempt(near);
        return normal_force_vector(twin.contact());
      };
      const Vector3 difference = (force_at(h) - force_at(-h)) / (2.0 * h);
      EXPECT_LT((by_q.col(k) - difference).norm(), 2e-3 * by_q.norm()) << "axis " << k;
    }
  }
}

TEST(Twin, AttemptsDoNotChangeWhatTheNextFrameStartsFrom) {
  const auto model = wearer();
  const auto device = thimble_under_test();
  Twin calm(model, device);
  Twin nervous(model, device);
  const double touch = touching_travel(*device, *model);
  for (Twin* twin : {&calm, &nervous}) twin->press(level(touch + 0.8 * mm), 0.5, 0.03);
  nervous.begin_frame(0.5, 0.03);
  for (const double pitch : {3.0, -3.0}) {
    Configuration q = level(touch + 1.1 * mm);
    q[0] = pitch * deg;
    nervous.attempt(q);
  }
  calm.begin_frame(0.5, 0.03);
  for (Twin* twin : {&calm, &nervous}) {
    twin->attempt(level(touch + 1.0 * mm));
    twin->keep();
  }
  EXPECT_NEAR(nervous.contact().normal_force, calm.contact().normal_force,
              2e-3 * calm.contact().normal_force);
}

// To search is to solve less fully: for the same forces, with fewer iterations.
TEST(Twin, FeelsTheSameToAThousandthWhereItOnlySearches) {
  const auto model = wearer();
  const auto device = thimble_under_test();
  const double touch = touching_travel(*device, *model);
  Twin judging(model, device);
  Twin searching(model, device, TwinPrecision::kSearching);
  int judged = 0;
  int searched = 0;
  for (int k = 1; k <= 12; ++k) {
    Configuration q(3);
    q << 0.02 * std::sin(k), 0.03 * std::cos(k), touch + 0.08 * mm * k;
    judged += judging.press(q, 0.5, 0.0).iterations;
    const TwinSummary summary = searching.press(q, 0.5, 0.0);
    EXPECT_TRUE(summary.converged);
    searched += summary.iterations;
    const Vector3 force = normal_force_vector(judging.contact());
    ASSERT_GT(force.norm(), 0.0);
    EXPECT_LT((normal_force_vector(searching.contact()) - force).norm(), 2e-3 * force.norm());
    EXPECT_LT(
        (searching.contact().tangential_force_F - judging.contact().tangential_force_F).norm(),
        5e-3 * force.norm());
  }
  EXPECT_LT(searched, 0.85 * judged);
}

TEST(Twin, IsFreeWhereTheDeviceIsHomeAndAfterItLeaves) {
  const auto model = wearer();
  const auto device = thimble_under_test();
  Twin twin(model, device);
  EXPECT_EQ(twin.contact().contact_count, 0);
  EXPECT_GT(twin.contact().least_gap, 2.0 * mm);
  twin.press(level(touching_travel(*device, *model) + 1.0 * mm), 0.5, 0.03);
  EXPECT_GT(twin.contact().normal_force, 0.1);
  twin.press(device->home(), 0.5, 0.03);
  EXPECT_EQ(twin.contact().contact_count, 0);
  for (std::size_t n = 0; n < twin.positions().size(); ++n) {
    EXPECT_LT((twin.positions()[n] - model->mesh.nodes[n]).norm(), 1e-6);
  }
}

TEST(Twin, SkinThatRelaxesPushesLessAfterAWhile) {
  const auto model = wearer("index-viscoelastic");
  const auto device = thimble_under_test();
  Twin twin(model, device);
  const Configuration q = level(touching_travel(*device, *model) + 1.0 * mm);
  twin.press(q, 0.0, 1e-3);
  const double at_once = twin.contact().normal_force;
  for (int k = 0; k < 100; ++k) twin.press(q, 0.0, 0.1);
  const double later = twin.contact().normal_force;
  EXPECT_NEAR(later / at_once, model->relaxation.long_time_fraction(), 0.05);
}

// What is given up leaves no trace, but which factors the solver has kept.
TEST(Twin, AnAttemptThatIsGivenUpLeavesTheNextWhereItBegan) {
  const auto model = wearer();
  const auto device = thimble_under_test();
  const double touch = touching_travel(*device, *model);
  Twin steady(model, device);
  Twin hasty(model, device);
  for (Twin* twin : {&steady, &hasty}) {
    twin->begin_frame(0.5, 0.0);
    EXPECT_TRUE(twin->attempt(level(touch + 0.5 * mm)).converged);
    TwinForces forces;
    ASSERT_TRUE(twin->forces_and_derivatives(forces));
  }
  const TwinSummary given_up = hasty.attempt(level(touch + 2.0 * mm), 3);
  EXPECT_FALSE(given_up.converged);
  EXPECT_LE(given_up.iterations, 3);
  const Configuration next = level(touch + 0.7 * mm);
  EXPECT_NEAR(hasty.attempt(next).iterations, steady.attempt(next).iterations, 1);
  const double force = steady.contact().normal_force;
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(hasty.contact().normal_force, force, 1e-5 * force);
  for (std::size_t n = 0; n < steady.positions().size(); ++n) {
    ASSERT_LT((hasty.positions()[n] - steady.positions()[n]).norm(), 1e-9) << n;
  }
  // One that has enough is the one without an end.
  const Configuration last = level(touch + 0.9 * mm);
  EXPECT_TRUE(hasty.attempt(last, 1000).converged);
  EXPECT_TRUE(steady.attempt(last).converged);
  EXPECT_NEAR(hasty.contact().normal_force, steady.contact().normal_force, 1e-5 * force);
}

}  // namespace
}  // namespace softfinger
