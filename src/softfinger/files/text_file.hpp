#pragma once

#include <cstddef>
#include <filesystem>
#include <stop_token>
#include <string>

namespace softfinger {

/// All bytes of a file of at most `max_size` bytes. Throws InputError "FILE: message" where it is
/// absent, a directory, a pipe, unreadable or larger, and when `stop` asks for an end.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, std::size_t max_size,
                                         const std::stop_token& stop = {});

}  // namespace softfinger
