#include "softfinger/contact/surface_patches.hpp"

namespace softfinger {
namespace {

/// Surfaces further from a sample than this are not looked for, m: gaps are known up to it.
constexpr double kWithin = 3e-3;

}  // namespace

void SurfacePatches::clear() {
  for (SurfacePatch& patch : patches_) patch.near = false;
  any_ = false;
}

void SurfacePatches::find(const DeformingSurface& surface, std::span<const Vector3> samples,
                          std::size_t o, std::size_t obstacle_count,
                          std::span<FrictionAnchor> anchors) {
  any_ = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    SurfacePatch& patch = patches_[i];
    FrictionAnchor& anchor = anchors[i * obstacle_count + o];
    DeformingSurface::Place& place = places_[i];
    const int near = patch.near ? place.triangle : -1;
    DeformingSurface::Place found;
    if (!surface.find(samples[i], kWithin, near, found)) {
      patch.near = false;
      anchor = FrictionAnchor{};
      continue;
    }
    const Pose X_WP = surface.frame(found);
    if (anchor.limit > 0.0) {
      const Pose X_WOld = surface.frame(place);
      anchor.anchor_O = X_WP.inverse() * (X_WOld * anchor.anchor_O);
      anchor.normal_O = X_WP.rotation.transpose() * (X_WOld.rotation * anchor.normal_O);
    }
    place = found;
    patch.near = true;
    patch.put(X_WP);
    any_ = true;
  }
}

void SurfacePatches::follow(std::span<const Vector3> nodes) {
  if (!any_) return;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (!patches_[i].near) continue;
    patches_[i].put({patches_[i].X_WP.rotation, places_[i].at(nodes)});
  }
}

}  // namespace softfinger
