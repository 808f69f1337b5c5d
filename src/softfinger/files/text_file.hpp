#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace softfinger {

/// All bytes of a file of at most `max_size` bytes. Throws InputError "FILE: message" where it is
/// absent, a directory, a pipe, unreadable or larger.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, std::size_t max_size);

}  // namespace softfinger
