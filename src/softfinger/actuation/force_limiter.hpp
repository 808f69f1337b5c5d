#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// How rough a wearer is taken to be where a force limit counts.
inline constexpr double kMostFriction = 1.5;

/// Keeps a device that moves its surface aside, dragging skin along, below its force limit. How
/// hard it presses then hangs on the way it came, so that no table can tell: a twin as stiff as
/// kStiffestWearer and as rough as kMostFriction is led along, and what would press it harder than
/// `[limits] max_force_N` is drawn back along the device's advance. limited() does not allocate.
class ForceLimiter {
 public:
  /// `device` needs a limit of force and an axis that advances it.
  ForceLimiter(const FingerModel& model, std::shared_ptr<const Device> device);

  /// Whether a device has a limit that hangs on the way: it moves aside, and not by pins.
  [[nodiscard]] static bool needed(const Device& device);

  /// q, drawn back where it would press too hard; the device is taken to go there in `elapsed` s.
  /// `friction_coefficient`: of what is touched; counts where it is more than kMostFriction.
  [[nodiscard]] Configuration limited(const Configuration& q, double friction_coefficient,
                                      double elapsed);
  /// Where the device went, if other limits led it elsewhere.
  void follow(const Configuration& went);

 private:
  struct Tried {
    double way;    ///< m
    double force;  ///< N
  };
  [[nodiscard]] Configuration drawn_back(const Configuration& q, double way) const;
  [[nodiscard]] Tried try_back(const Configuration& q, double way);
  [[nodiscard]] double way_back(const Configuration& q, double most);

  Twin twin_;
  double back_ = 0.0;       ///< that the last answer was drawn back, m
  Configuration limited_;   ///< the last answer
  bool under_way_ = false;  ///< its frame has not ended
};

}  // namespace softfinger
