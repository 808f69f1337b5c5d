#pragma once

#include <string>

namespace softfinger {

/// An OBJ file whose import takes a second or so.
inline std::string text_of_large_mesh() {
  std::string text;
  for (int i = 0; i < 600'000; ++i) {
    const std::string number = std::to_string(i);
    text += "v " + number + " 0 1\nv 0 " + number + " 1\nv 1 0 " + number + "\nf -1 -2 -3\n";
  }
  return text;
}

}  // namespace softfinger
