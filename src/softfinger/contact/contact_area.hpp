#pragma once

#include "softfinger/contact/contact_report.hpp"
#include "softfinger/contact/divided_triangle.hpp"

namespace softfinger {

/// Finds the area of the deformed skin that is in contact, whatever the size of its triangles, and
/// how much of each of them is: the skin
/// between the samples is curved by their normals (CurvedTriangle), and of each triangle that part
/// counts whose gap, looked up inside it, is at most the tolerance.
///
/// A sample that bears force is held where it is; let go, it would be further in by what a flat
/// punch of its area is under that force. Its gap counts as less by so much, so that the border of
/// contact, which lies between a sample that bears force and one that does not, moves with the
/// force: without that, contact ends at the last sample.
///
/// `set` has what report_contact() knows of samples and features. Allocates nothing.
void report_area(const SkinSurface& skin, const SettledContact& contact, ContactSet& set);

/// One triangle of the skin as report_area() left it: which places in it are in contact.
class TriangleInContact {
 public:
  /// `triangle` of the skin, between these samples.
  TriangleInContact(const ContactSet& set, std::size_t triangle, const std::array<int, 3>& samples);
  /// Whether the place with these weights of the corners is in contact.
  [[nodiscard]] bool has(const std::array<double, 3>& weights) const;

 private:
  TriangleContact::Extent extent_;
  DividedTriangle divided_;
};

/// How far a flat rigid punch is pressed into an elastic half-space, m: force N on area m^2,
/// plane_modulus E / (1 - nu^2), Pa (Johnson, "Contact Mechanics", 1985, eq. 3.36, for a round
/// one).
[[nodiscard]] double punch_depth(double force, double area, double plane_modulus);

}  // namespace softfinger
