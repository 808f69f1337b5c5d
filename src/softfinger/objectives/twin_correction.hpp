#pragma once

#include <memory>
#include <span>

#include "softfinger/matching/skin_clearance.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/objectives/force_aware_matching.hpp"

namespace softfinger {

/// The running loop's behaviour with objectives "surface_and_force" and "stress": what
/// SurfaceFollowing wants, put right by what the twin feels. Off the skin the correction is given
/// back at a bounded rate, at the gap to the skin that SurfaceFollowing wants, so that neither
/// touch nor release, nor a twin that loses contact, makes the device jump, and nothing is pressed
/// where nothing touches. Beside SurfaceFollowing's own motion the device moves as fast as its
/// EasingRates say. tick() does not allocate.
class TwinCorrection {
 public:
  TwinCorrection(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> device, MatchingOptions matching = {},
                 ForceAwareOptions options = {});

  void reset();
  /// One device tick after SurfaceFollowing's, `elapsed` s after the last. `nodes_F`: see
  /// ForceAwareMatching::match().
  const RenderedSurface& tick(const ContactSet& contact, std::span<const Vector3> nodes_F,
                              const RenderedSurface& surface, double elapsed);
  /// See ForceAwareMatching::follow().
  void follow(const Configuration& went) { force_.follow(went); }

 private:
  std::shared_ptr<const Device> device_;
  MatchingOptions matching_;
  ForceAwareMatching force_;
  SkinClearance skin_;
  Configuration correction_;  ///< rendered minus SurfaceFollowing's
  RenderedSurface rendered_;
};

}  // namespace softfinger
