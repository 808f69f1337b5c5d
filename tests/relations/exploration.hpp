#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger::relations {

/// A finger on its way over objects.
struct Exploration {
  std::string what;  ///< in words, to find it again
  std::shared_ptr<const FingerModel> model;
  std::vector<VirtualObject> objects;
  Trajectory motion;     ///< X_WFt
  double rate = 1000.0;  ///< of the simulation, Hz
};

/// What one step left, vectors in W.
struct Moment {
  double time = 0.0;  ///< s
  Pose X_WFt, X_WF;
  double normal_force = 0.0, tangential_force = 0.0;  ///< N, as reported
  double contact_area = 0.0;                          ///< m^2
  double least_gap = 0.0;                             ///< m
  int contact_count = 0;
  Vector3 force_W = Vector3::Zero();   ///< of all samples, N
  Vector3 torque_W = Vector3::Zero();  ///< of the same about F's origin, N m
};

struct Trace {
  std::vector<Moment> moments;
  std::vector<Vector3> positions_W;  ///< of all nodes at the end, m
  double most_force = 0.0;           ///< N
  int unconverged = 0;               ///< steps
  std::uint64_t hash = 0;            ///< of the state at the end

  [[nodiscard]] const Moment& last() const { return moments.back(); }
};

/// Called after each step.
using Look = std::function<void(const FingerSimulation&, const Moment&)>;

/// Runs it from the first waypoint to the last.
[[nodiscard]] Trace explore(const Exploration& exploration, const Look& look = {},
                            ThreadTeam* team = nullptr);

/// The whole scene and path taken elsewhere: turned and moved by X_VW, shifted in time (s).
[[nodiscard]] Exploration moved(const Exploration& exploration, const Pose& X_VW,
                                double time_shift = 0.0);

/// The same without points inside triangles.
[[nodiscard]] Exploration of_samples(Exploration exploration);

/// Of two traces with as many moments: the greatest departure over all of them, forces as a part of
/// the greatest force of `a`; `b` was moved by X_VW.
struct Departure {
  double normal_force = 0.0;
  double force = 0.0;       ///< of the net force vector, friction with it
  double mean_force = 0.0;  ///< the same, the mean over all moments
  double bone = 0.0;        ///< m
  double area = 0.0;        ///< m^2
  /// Where the net force departs most: the moment (s), and the normal forces there (N).
  std::string where;
};
[[nodiscard]] Departure departure(const Trace& a, const Trace& b, const Pose& X_VW = {});

/// Expects traces to be alike to `tolerance` in normal force, net force and (1 mm) the bone's
/// place. Where `exploration` has friction, two runs that differ by rounding may stop a pass apart,
/// which moves its limits by a hundredth; and a point inside a triangle that catches or lets go a
/// step earlier takes what it bears along: net forces are held to more then.
void expect_agreement(const Departure& most, const Exploration& exploration, double tolerance,
                      const std::string& what = {});

}  // namespace softfinger::relations
