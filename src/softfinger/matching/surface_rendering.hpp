#pragma once

#include <memory>
#include <string_view>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

/// What the device is doing for the wearer.
enum class RenderingState { kHome, kApproaching, kTouching, kHolding };
[[nodiscard]] std::string_view to_string(RenderingState state);

struct RenderedSurface {
  Configuration configuration;  ///< wanted q, inside the workspace
  JointAngles joints;           ///< of it, rad
  RenderingState state = RenderingState::kHome;
  double deviation = 0.0;  ///< E of the match, m^2; 0 when nothing is in contact
  int iterations = 0;
  Termination termination = Termination::kConverged;
};

/// The running loop's device behaviour, one tick at a time: in contact the match; without contact
/// but with an object nearer than the device's approach distance, the same least gap to the skin,
/// facing along the object's nearest normal; else home, or the nearest to home that clears the
/// skin. Changes between these are eased, so that touch and release do not jump; the skin is left
/// only after two ticks without contact. tick() does not allocate.
class SurfaceRendering {
 public:
  /// `capacity`: number of skin samples.
  SurfaceRendering(std::shared_ptr<const Device> device, int capacity,
                   MatchingOptions options = {});
  ~SurfaceRendering();
  SurfaceRendering(SurfaceRendering&&) noexcept;
  SurfaceRendering& operator=(SurfaceRendering&&) noexcept;

  /// Back to home, no history.
  void reset();
  /// One device tick.
  const RenderedSurface& tick(const ContactSet& contact);
  [[nodiscard]] const RenderedSurface& latest() const;
  [[nodiscard]] const Device& device() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
