#pragma once

#include <memory>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

/// What the device is doing for the wearer.
enum class RenderingState { kHome, kApproaching, kTouching, kLingering };

struct RenderedSurface {
  Configuration configuration;  ///< wanted q, inside the workspace
  JointAngles joints;           ///< of it, rad
  RenderingState state = RenderingState::kHome;
  double deviation = 0.0;  ///< E at configuration, m^2; 0 when nothing is in contact
  int iterations = 0;
  Termination termination = Termination::kConverged;
};

/// The running loop's device behaviour, one tick at a time: in contact the match; without contact
/// but with an object nearer than the device's approach distance, the same least gap to the skin,
/// facing along the object's nearest normal; else home, or the nearest to home that clears the
/// skin. Changes of no meaning, those of a contact set that comes and goes and those between
/// approach, touch, release and home, are given back as fast as the device's EasingRates say: turns
/// on the skin, the device then being as far advanced as E is least, gap and orientation off it.
/// Nothing delays a touch or a release. The device presses only while something touches, and leaves
/// the skin only after two ticks without contact. tick() does not allocate.
class SurfaceFollowing {
 public:
  /// `capacity`: number of skin samples; features have room besides.
  SurfaceFollowing(std::shared_ptr<const Device> device, int capacity,
                   MatchingOptions options = {});
  ~SurfaceFollowing();
  SurfaceFollowing(SurfaceFollowing&&) noexcept;
  SurfaceFollowing& operator=(SurfaceFollowing&&) noexcept;

  /// Back to home, no history.
  void reset();
  /// One device tick, `elapsed` s (>= 0) after the last.
  const RenderedSurface& tick(const ContactSet& contact, double elapsed);
  [[nodiscard]] const RenderedSurface& latest() const;
  [[nodiscard]] const Device& device() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
