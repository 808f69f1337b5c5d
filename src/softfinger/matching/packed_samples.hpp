#pragma once

#include <vector>

#include "softfinger/device/surface_samples.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

/// Skin points as a device's surface takes them: those in contact first, in their order, each
/// coordinate by itself. Allocates only in the constructor.
class PackedSamples {
 public:
  /// `capacity`: most points; the rest is ignored.
  explicit PackedSamples(int capacity);

  /// Valid until the next. `separation_tolerance`: eps where the options have none, m.
  [[nodiscard]] SurfaceSamples pack(const ContactPoints& points, const MatchingOptions& options,
                                    double separation_tolerance);

 private:
  std::vector<double> x_, y_, z_, weight_, margin_;
};

}  // namespace softfinger
