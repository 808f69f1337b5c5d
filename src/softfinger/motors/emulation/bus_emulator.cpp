#include "softfinger/motors/emulation/bus_emulator.hpp"

#include <algorithm>

namespace softfinger {

bool ReplyBuffer::add(std::span<const std::uint8_t> bytes) {
  if (size_ + bytes.size() > bytes_.size()) return false;
  std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += bytes.size();
  return true;
}

std::size_t ReplyBuffer::take(std::span<std::uint8_t> out) {
  const std::size_t size = std::min(out.size(), size_);
  const auto middle = bytes_.begin() + static_cast<std::ptrdiff_t>(size);
  std::copy(bytes_.begin(), middle, out.begin());
  std::copy(middle, bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.begin());
  size_ -= size;
  return size;
}

}  // namespace softfinger
