#pragma once

#include <memory>

#include "softfinger/files/config_file.hpp"
#include "softfinger/finger/soft_solid.hpp"

namespace softfinger {

/// Tetrahedra and material of an `[[object]]` that is soft: `file`, `unit`, `[object.material]`,
/// `[object.strain_limits]`. Without `with_file` the mesh is left out, for a schema. Throws
/// InputError with file, line and key.
[[nodiscard]] std::shared_ptr<const SoftSolid> read_soft(const ConfigTable& table, bool with_file);

}  // namespace softfinger
