// What holds at every moment of any exploration: forces balance, friction stays inside its cone,
// and force and contact go together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/contact/contact_potential.hpp"

namespace softfinger::relations {
namespace {

// At rest the coupling bears what the objects push: force and torque about F's origin. Residuals
// of the steps are 1e-6; the bone has stopped, but for one whose skin still relaxes, and the
// coupling's damper bears the rest.
TEST(Balance, OfContactAndCoupling) {
  int at_rest = 0;
  for (int number = 0; number < cases(8); ++number) {
    Draw draw("coupling", number);
    const Exploration exploration =
        draw_exploration(draw, number, kSmoothThings, {Path::kPress, Path::kSlide, Path::kRoll});
    Exploration held = exploration;
    std::vector<Waypoint> waypoints = exploration.motion.waypoints();
    waypoints.push_back({waypoints.back().time + 0.5, waypoints.back().pose});
    held.motion = Trajectory(waypoints);
    const Trace trace = explore(held);
    ASSERT_GT(trace.most_force, 0.01) << exploration.what;
    const Moment& last = trace.last();
    if (last.normal_force < 0.01) continue;  // slid off the object
    ++at_rest;
    const double tolerance = held.model->relaxation.terms.empty() ? 1e-3 : 0.01;
    const Coupling& coupling = held.model->coupling;
    const Vector3 pull =
        coupling.translation_stiffness * (last.X_WFt.translation - last.X_WF.translation);
    EXPECT_LT((pull + last.force_W).norm(), tolerance * last.normal_force) << exploration.what;
    const Vector3 twist = coupling.rotation_stiffness *
                          log_rotation(last.X_WFt.rotation * last.X_WF.rotation.transpose());
    EXPECT_LT((twist + last.torque_W).norm(), tolerance * last.normal_force * 10 * mm)
        << exploration.what;
  }
  EXPECT_GT(at_rest, cases(4));
}

// Friction in no step beyond what the normal force of that step allows, sample by sample and in
// all: to the hundredth within which a step's passes bring each sample. The vector sum of
// tangential forces is at most the sum of their limits.
TEST(Balance, FrictionStaysInsideItsCone) {
  for (int number = 0; number < cases(8); ++number) {
    Draw draw("cone", number);
    const Exploration exploration = draw_exploration(draw, number, kAllThings);
    const double mu = *exploration.objects.front().friction_coefficient;
    double most_ratio = 0.0, most_slip = 0.0;
    const Trace trace =
        explore(exploration, [&](const FingerSimulation& simulation, const Moment& moment) {
          // Each by itself: around a bead they push different ways.
          double normal = 0.0;
          for (const ContactSample& sample : simulation.contact().samples)
            normal += sample.own_normal_force;
          for (const ContactFeature& feature : simulation.contact().features())
            normal += feature.normal_force_F.norm();
          if (mu > 0.0) {
            most_ratio = std::max(most_ratio, moment.tangential_force / (mu * normal + 1e-4));
          } else {
            EXPECT_LT(moment.tangential_force, 1e-9) << exploration.what;
          }
          most_slip = std::max(most_slip, simulation.contact().slip_ratio);
        });
    ASSERT_GT(trace.most_force, 0.01) << exploration.what;
    EXPECT_LT(most_ratio, 1.0 + ContactPotential::kConeRelative) << exploration.what;
    EXPECT_LT(most_slip, 1.0 + ContactPotential::kConeRelative) << exploration.what;
  }
}

// Members of C, samples and features, bear all of the force but a thousandth (what the report
// leaves to those below 1e-6 N), and where there is none nothing is in contact.
TEST(Balance, WhatBearsForceIsInContact) {
  int by_features = 0;  // moments
  for (int number = 0; number < cases(8); ++number) {
    Draw draw("contact", number);
    const Exploration exploration = draw_exploration(draw, number, kAllThings);
    int touched = 0;
    double left_out = 0.0;   // force of what is out of contact, as a part of all
    double untouched = 0.0;  // N, where nothing is in contact
    const Trace trace =
        explore(exploration, [&](const FingerSimulation& simulation, const Moment& moment) {
          const ContactSet& contact = simulation.contact();
          const double all = contact.normal_force_sum;
          double borne = 0.0;
          for (const ContactSample& sample : contact.samples) {
            if (!sample.in_contact) continue;
            borne += sample.own_normal_force;
            EXPECT_GT(sample.own_normal_force, 0.0) << exploration.what;
          }
          for (const ContactFeature& feature : contact.features()) {
            borne += feature.normal_force_F.norm();
          }
          by_features += contact.features().empty() ? 0 : 1;
          if (moment.contact_count > 0) {
            EXPECT_GT(moment.contact_area, 0.0) << exploration.what;
          }
          if (moment.contact_count > 0) {
            ++touched;
            left_out = std::max(left_out, (all - borne) / (all + 1e-3));
            EXPECT_GT(moment.normal_force, 0.0) << exploration.what;
          } else {
            untouched = std::max(untouched, moment.normal_force);
          }
        });
    ASSERT_GT(trace.most_force, 0.01) << exploration.what;
    EXPECT_GT(touched, 20) << exploration.what;
    EXPECT_LT(left_out, 1e-3) << exploration.what;
    EXPECT_LT(untouched, 1e-3) << exploration.what;
  }
  EXPECT_GT(by_features, 20);
}

// One meaning everywhere: the magnitude of the vector sum. Rounding alone.
TEST(Balance, TheNormalForceIsTheMagnitudeOfTheSum) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("sum", number);
    const Exploration exploration = draw_exploration(draw, number, kAllThings);
    double apart = 0.0;
    const Trace trace =
        explore(exploration, [&](const FingerSimulation& simulation, const Moment& moment) {
          Vector3 sum = Vector3::Zero();
          for (const ContactSample& sample : simulation.contact().samples) {
            sum += sample.normal_force_F;
          }
          apart = std::max(apart, std::abs(sum.norm() - moment.normal_force));
        });
    ASSERT_GT(trace.most_force, 0.01) << exploration.what;
    EXPECT_LT(apart, 1e-9 * trace.most_force) << exploration.what;
  }
}

// A finger that is held still comes to rest, with friction and without, on sharp things too: in
// the last tenth of a second its force changes by less than 1 % of the run's greatest, what is left
// of the bone's oscillation, where skin relaxes by less than 2 %; and nothing of it trembles from
// step to step.
constexpr double kStill = 1 * mm;  // a second

TEST(Balance, AHeldFingerComesToRest) {
  int at_rest = 0;
  for (int number = 0; number < cases(6); ++number) {
    Draw draw("rest", number);
    Exploration exploration =
        draw_exploration(draw, number, kAllThings, {Path::kPress, Path::kSlide, Path::kRoll});
    if (draw.chance(0.5)) exploration.objects.front().friction_coefficient = 0.0;
    std::vector<Waypoint> waypoints = exploration.motion.waypoints();
    waypoints.push_back({waypoints.back().time + 0.5, waypoints.back().pose});
    exploration.motion = Trajectory(waypoints);
    const double from = exploration.motion.end_time() - 0.1;
    double least = 1e9, most = 0.0, fastest = 0.0;
    const Trace trace =
        explore(exploration, [&](const FingerSimulation& simulation, const Moment& moment) {
          if (moment.time < from) return;
          for (const Vector3& velocity : simulation.velocities())
            fastest = std::max(fastest, velocity.norm());
          least = std::min(least, moment.normal_force);
          most = std::max(most, moment.normal_force);
        });
    ASSERT_GT(trace.most_force, 0.01) << exploration.what;
    const double left = exploration.model->relaxation.terms.empty() ? 0.01 : 0.02;
    EXPECT_LT(most - least, left * trace.most_force) << exploration.what;
    EXPECT_LT(fastest, kStill) << exploration.what;
    at_rest += most > 0.01 ? 1 : 0;  // else slid off the object
  }
  EXPECT_GT(at_rest, cases(3));
}

}  // namespace
}  // namespace softfinger::relations
