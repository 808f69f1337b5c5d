#include "softfinger/motors/servo_table/frame_reader.hpp"

#include <algorithm>

namespace softfinger {

std::optional<ServoFrame> FrameReader::next() {
  std::optional<ServoFrame> frame;
  std::size_t begin = 0;
  while (begin < size_ && !frame) {
    const auto rest = std::span<const std::uint8_t>(buffer_).subspan(begin, size_ - begin);
    const int length = protocol_->frame_length(rest);
    // A frame that does not end within the buffer never will.
    if (length == 0 && rest.size() < buffer_.size()) break;
    if (length > 0) {
      frame = protocol_->decode(rest.first(static_cast<std::size_t>(length)));
      begin += static_cast<std::size_t>(length);
      ++frames_;
    } else {
      ++begin;
      ++malformed_;
    }
  }
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin),
            buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
  size_ -= begin;
  return frame;
}

}  // namespace softfinger
