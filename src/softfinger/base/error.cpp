#include "softfinger/base/error.hpp"

#include <algorithm>

namespace softfinger {

std::string in_one_line(std::string text) {
  std::ranges::replace_if(
      text,
      [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return code < 0x20 || code == 0x7f;
      },
      '?');
  return text;
}

}  // namespace softfinger
