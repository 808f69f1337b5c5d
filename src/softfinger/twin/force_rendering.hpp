#pragma once

#include <memory>
#include <span>

#include "softfinger/matching/surface_rendering.hpp"
#include "softfinger/twin/force_aware_matching.hpp"

namespace softfinger {

/// The running loop's behaviour with objectives "surface_and_force" and "stress": what
/// SurfaceRendering wants, put right by what the twin feels. Off the skin the correction is given
/// back at a bounded rate, so that neither touch nor release, nor a twin that loses contact, makes
/// the device jump. tick() does not allocate.
class ForceRendering {
 public:
  ForceRendering(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> device, MatchingOptions matching = {},
                 ForceAwareOptions options = {});

  void reset();
  /// One device tick after SurfaceRendering's, `elapsed` s after the last. `nodes_F`: see
  /// ForceAwareMatching::match().
  const RenderedSurface& tick(const ContactSet& contact, std::span<const Vector3> nodes_F,
                              const RenderedSurface& surface, double elapsed);

 private:
  std::shared_ptr<const Device> device_;
  MatchingOptions matching_;
  ForceAwareMatching force_;
  Configuration correction_;  ///< rendered minus SurfaceRendering's
  RenderedSurface rendered_;
};

}  // namespace softfinger
