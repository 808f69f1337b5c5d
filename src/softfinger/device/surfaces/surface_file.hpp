#pragma once

#include <string>
#include <vector>

#include "softfinger/device/surfaces/surface_piece.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

/// `[[surface]]` of a device file: pieces of what touches the finger, each on the body that its
/// `body` names; on body 0 where `bodies` is empty, then there is no such key. Without
/// `load_meshes` the files of meshes are not opened.
[[nodiscard]] std::vector<SurfacePiece> read_surface(const ConfigTable& root,
                                                     const std::vector<std::string>& bodies,
                                                     bool load_meshes);

}  // namespace softfinger
