#include "softfinger/files/text_file.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>

#include "softfinger/base/error.hpp"
#include "softfinger/base/stop_check.hpp"

namespace softfinger {

std::string read_text_file(const std::filesystem::path& file, std::size_t max_size,
                           const std::stop_token& stop) {
  const auto fail = [&](std::string_view message) {
    throw InputError(fmt::format("{}: {}", file.string(), message));
  };
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) fail("is a directory, expected a file");
  // Where nobody writes to a pipe it would not even open; files are read more than once as well.
  if (std::filesystem::is_fifo(file, error)) fail("is a pipe, expected a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(std::filesystem::exists(file, error) ? "cannot be read" : "no such file");
  std::string text;
  std::array<char, 1 << 16> buffer;
  while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0) {
    StopCheck::now(stop);
    text.append(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > max_size) fail(fmt::format("is larger than {} MB", max_size >> 20));
  }
  if (stream.bad()) fail("cannot be read");
  return text;
}

}  // namespace softfinger
