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

/// Limits of friction are sought to 1 %: two runs that differ by rounding may stop a pass apart.
inline constexpr double kLimits = 0.01;
inline constexpr double kLimitsOfNormals = 0.003;

/// Of two traces with as many moments: the greatest departure over all of them, forces as a part of
/// the greatest force of `a`; `b` was moved by X_VW.
struct Departure {
  double normal_force = 0.0;
  double force = 0.0;  ///< of the net force vector, friction with it
  double bone = 0.0;   ///< m
  double area = 0.0;   ///< m^2
  /// Where the net force departs most: the moment (s), and the normal forces there (N).
  std::string where;
};
[[nodiscard]] Departure departure(const Trace& a, const Trace& b, const Pose& X_VW = {});

}  // namespace softfinger::relations
