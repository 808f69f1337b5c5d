#pragma once

#include <cstdint>
#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

/// A contact set as matching sees it: its samples and, behind them, its features. What touches a
/// soft object counts by its pressure as a part of the greatest there: such contact spreads far at
/// next to no force, and a rigid surface that was to touch all of it alike would press too hard.
/// Allocates only in the constructor.
class SkinPoints {
 public:
  /// `capacity`: most samples, the rest is ignored; features have room besides.
  explicit SkinPoints(int capacity);

  /// Valid until the next. `touching`: false, none is in contact.
  [[nodiscard]] ContactPoints take(const ContactSet& contact, bool touching = true);

 private:
  std::vector<Vector3> points_F_;
  std::vector<std::uint8_t> in_contact_, nothing_touches_;
  std::vector<double> areas_, gaps_, shares_;
};

}  // namespace softfinger
