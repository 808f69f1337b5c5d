#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/handle.hpp"
#include "softfinger/rendering.hpp"

namespace softfinger {

/// A rendering and what its calls leave between them.
struct HeldRendering {
  /// Throws InputError.
  HeldRendering(const char* scene, const sf_options* options);

  const RenderingSnapshot& newest() {
    if (!fresh) rendering.snapshot(snapshot, selected);
    fresh = true;
    return snapshot;
  }

  Rendering rendering;
  std::vector<std::string> fingers, objects;
  std::vector<std::vector<std::string>> components;        ///< of each finger's configuration
  std::vector<std::optional<Pose>> poses;                  ///< of each, of the call under way
  std::size_t selected = 0;                                ///< finger that is told of
  std::vector<Vector3> surface;                            ///< of the object asked for last
  double time = -std::numeric_limits<double>::infinity();  ///< of the last call, s
  RenderingSnapshot snapshot;
  bool fresh = true;
};

}  // namespace softfinger

struct sf_rendering : softfinger::Handle<softfinger::HeldRendering> {
  using Handle::Handle;
};

namespace softfinger {

using RenderingUse = Handle<HeldRendering>::Use;

}  // namespace softfinger
