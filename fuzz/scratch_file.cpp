#include "scratch_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

namespace softfinger {

ScratchFile::ScratchFile(std::string_view name)
    : folder_(std::filesystem::path("/dev/shm") / ("softfinger-fuzz-" + std::to_string(getpid()))),
      path_(folder_ / name) {
  std::filesystem::create_directories(folder_);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void ScratchFile::write(std::span<const std::uint8_t> bytes) const {
  std::ofstream out(path_, std::ios::binary | std::ios::trunc);
  for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
}

std::vector<std::uint8_t> ScratchFile::read() const {
  std::ifstream in(path_, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::uint8_t> damaged(std::vector<std::uint8_t> sound,
                                  std::span<const std::uint8_t> damage, std::size_t head) {
  const std::size_t whole = sound.size();
  for (; damage.size() >= 5; damage = damage.subspan(5)) {
    const std::size_t where =
        damage[0] | std::size_t{damage[1]} << 8 | std::size_t{damage[2]} << 16;
    if (damage[3] == 0xFF) {
      sound.resize(where % (whole + 1));
    } else if (!sound.empty()) {
      const std::size_t size = sound.size();
      sound[where % (damage[3] % 2 == 0 ? std::min(head, size) : size)] = damage[4];
    }
  }
  return sound;
}

}  // namespace softfinger
