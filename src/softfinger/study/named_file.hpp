#pragma once

#include <filesystem>
#include <string>

#include "softfinger/files/config_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/study/study.hpp"

namespace softfinger {

/// The file that `key` of a study in `directory` names: a path relative to it, or the name of a
/// shipped one. Throws InputError with file, line and key.
[[nodiscard]] StudyFile named_file(const ConfigTable& table, const char* key, Shipped kind,
                                   const std::filesystem::path& directory, const std::string& word);

}  // namespace softfinger
