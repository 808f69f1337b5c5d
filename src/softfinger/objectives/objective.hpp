#pragma once

#include <span>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/matching/surface_following.hpp"

namespace softfinger {

/// The virtual finger at a device tick. Views.
struct VirtualFinger {
  const ContactSet& contact;
  std::span<const Vector3> nodes_W;  ///< all, m
  const Pose& X_WF;
};

/// What the device's configuration is chosen for: where the device shall go, tick by tick. One pair
/// of files each beside this one, one row each of objective_kinds().
class Objective {
 public:
  Objective() = default;
  Objective(const Objective&) = delete;
  Objective& operator=(const Objective&) = delete;
  virtual ~Objective() = default;

  /// One device tick, `elapsed` s (>= 0) after the last. The result stays valid until the next.
  /// Allocates nothing, takes no lock, throws nothing.
  virtual const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) = 0;
  /// After a tick: where the device went for the model, limits in the way included. As tick().
  virtual void follow(const Configuration& went) { static_cast<void>(went); }
};

}  // namespace softfinger
