#pragma once

#include <span>
#include <vector>

#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/contact/deforming_surface.hpp"

namespace softfinger {

/// Where the samples of one body meet the surface of another that deforms. Patches are found at the
/// start of a step; within it they move with the surface and do not turn.
class SurfacePatches {
 public:
  explicit SurfacePatches(std::size_t samples) : patches_(samples), places_(samples) {}

  /// Nothing is near.
  void clear();
  /// The surface and the samples (W, m) stand where they are at the start of a step. `anchors` of
  /// all samples and obstacles, of which this one is number o among `obstacle_count`: friction goes
  /// on as far from where it holds as it was, though it holds in another patch.
  void find(const DeformingSurface& surface, std::span<const Vector3> samples, std::size_t o,
            std::size_t obstacle_count, std::span<FrictionAnchor> anchors);
  /// The nodes of the soft object's mesh stand there, W, m.
  void follow(std::span<const Vector3> nodes);

  [[nodiscard]] bool any() const { return any_; }
  [[nodiscard]] std::span<const SurfacePatch> patches() const { return patches_; }
  /// Of sample i; valid where its patch is near.
  [[nodiscard]] const DeformingSurface::Place& place(std::size_t i) const { return places_[i]; }

 private:
  std::vector<SurfacePatch> patches_;
  std::vector<DeformingSurface::Place> places_;
  bool any_ = false;
};

}  // namespace softfinger
