#include "exploration.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger::relations {
namespace {

/// How near to each other two runs are held: forces as parts of the greatest, the bone in m.
struct Agreement {
  double normal_force, force, mean_force, bone;
};
/// Limits of friction are sought to 1 %.
constexpr Agreement kOfFriction{5e-3, 0.01, 1e-3, 5e-3 * mm};
/// What points inside triangles bear that catch or let go.
constexpr Agreement kOfCatching{5e-3, 0.3, 0.1, 0.1 * mm};

Agreement wider(const Agreement& a, const Agreement& b) {
  return {std::max(a.normal_force, b.normal_force), std::max(a.force, b.force),
          std::max(a.mean_force, b.mean_force), std::max(a.bone, b.bone)};
}

Moment moment_of(const FingerSimulation& simulation, const Pose& X_WFt, double time) {
  const ContactSet& contact = simulation.contact();
  const Pose& X_WF = simulation.bone_pose();
  Moment moment{.time = time,
                .X_WFt = X_WFt,
                .X_WF = X_WF,
                .normal_force = contact.normal_force,
                .tangential_force = contact.tangential_force,
                .contact_area = contact.contact_area,
                .least_gap = contact.least_gap,
                .contact_count = contact.contact_count};
  for (const ContactSample& sample : contact.samples) {
    const Vector3 force_F = sample.normal_force_F + sample.tangential_force_F;
    moment.force_W += X_WF.rotation * force_F;
    moment.torque_W += X_WF.rotation * sample.position_F.cross(force_F);
  }
  return moment;
}

}  // namespace

Trace explore(const Exploration& exploration, const Look& look, ThreadTeam* team) {
  const double step = 1.0 / exploration.rate;
  FingerSimulation simulation(exploration.model, exploration.objects, step, team);
  const double start = exploration.motion.start_time();
  const auto steps =
      static_cast<int>(std::lround((exploration.motion.end_time() - start) * exploration.rate));
  simulation.reset(exploration.motion.sample(start), start);
  Trace trace;
  trace.moments.reserve(static_cast<std::size_t>(steps));
  for (int k = 1; k <= steps; ++k) {
    const double time = start + k * step;
    const Pose X_WFt = exploration.motion.sample(time);
    const StepSummary summary = simulation.step(X_WFt, time);
    trace.unconverged += summary.converged ? 0 : 1;
    trace.moments.push_back(moment_of(simulation, X_WFt, time));
    trace.most_force = std::max(trace.most_force, trace.last().normal_force);
    if (look) look(simulation, trace.last());
  }
  EXPECT_LE(trace.unconverged, 1 + steps / 100) << exploration.what;
  trace.positions_W.assign(simulation.positions().begin(), simulation.positions().end());
  trace.hash = simulation.state_hash();
  return trace;
}

Exploration moved(const Exploration& exploration, const Pose& X_VW, double time_shift) {
  const auto carried = [&](const Trajectory& motion) {
    std::vector<Waypoint> waypoints = motion.waypoints();
    for (Waypoint& waypoint : waypoints) {
      waypoint.pose = X_VW * waypoint.pose;
      waypoint.time += time_shift;
    }
    return Trajectory(std::move(waypoints));
  };
  Exploration result = exploration;
  result.motion = carried(exploration.motion);
  for (VirtualObject& object : result.objects) object.motion = carried(object.motion);
  return result;
}

Exploration of_samples(Exploration exploration) {
  auto model = std::make_shared<FingerModel>(*exploration.model);
  model->feature_contact = false;
  exploration.model = model;
  return exploration;
}

Departure departure(const Trace& a, const Trace& b, const Pose& X_VW) {
  Departure most;
  EXPECT_EQ(a.moments.size(), b.moments.size());
  for (std::size_t k = 0; k < std::min(a.moments.size(), b.moments.size()); ++k) {
    const Moment& one = a.moments[k];
    const Moment& other = b.moments[k];
    most.normal_force =
        std::max(most.normal_force, std::abs(one.normal_force - other.normal_force));
    const double force = (X_VW.rotation * one.force_W - other.force_W).norm();
    if (force >= most.force) {
      most.force = force;
      most.where = fmt::format("; most at {:.4f} s, {:.4g} and {:.4g} of {:.4g} N", one.time,
                               one.normal_force, other.normal_force, a.most_force);
    }
    most.mean_force += force;
    most.bone = std::max(most.bone, (X_VW * one.X_WF.translation - other.X_WF.translation).norm());
    most.area = std::max(most.area, std::abs(one.contact_area - other.contact_area));
  }
  most.normal_force /= a.most_force;
  most.force /= a.most_force;
  most.mean_force /= a.most_force * static_cast<double>(a.moments.size());
  return most;
}

void expect_agreement(const Departure& most, const Exploration& exploration, double tolerance,
                      const std::string& what) {
  const bool rubs = std::ranges::any_of(exploration.objects, [&](const VirtualObject& object) {
    return object.friction_coefficient.value_or(exploration.model->friction_coefficient) > 0.0;
  });
  Agreement least{tolerance, tolerance, tolerance, tolerance * mm};
  if (rubs) {
    least = wider(least, exploration.model->feature_contact ? kOfCatching : kOfFriction);
  }
  const std::string where = exploration.what + most.where + what;
  EXPECT_LT(most.normal_force, least.normal_force) << where;
  EXPECT_LT(most.force, least.force) << where;
  EXPECT_LT(most.mean_force, least.mean_force) << where;
  EXPECT_LT(most.bone, least.bone) << where;
}

}  // namespace softfinger::relations
