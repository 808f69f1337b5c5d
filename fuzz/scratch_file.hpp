#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "softfinger/base/error.hpp"

namespace softfinger {

/// A file in a folder of its own in memory, for readers that take a path. Gone with the process.
class ScratchFile {
 public:
  explicit ScratchFile(std::string_view name);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void write(std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] std::vector<std::uint8_t> read() const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
};

/// What damage does to a sound file, five bytes each: where (4; half of it among the first `head`
/// bytes), what (1). A file of noise alone would never get past its reader's first check.
[[nodiscard]] std::vector<std::uint8_t> damaged(std::vector<std::uint8_t> sound,
                                                std::span<const std::uint8_t> damage,
                                                std::size_t head);

/// Calls `read`. Refusing the input is right; anything else thrown ends the fuzzer, as does a
/// message that is not one line.
template <typename Read>
void read_or_refuse(Read read) {
  try {
    read();
  } catch (const InputError& refusal) {
    const std::string_view line = refusal.what();
    if (line.empty() || line.find('\n') != std::string_view::npos) __builtin_trap();
  }
}

}  // namespace softfinger
