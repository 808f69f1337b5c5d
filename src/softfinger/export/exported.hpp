#pragma once

#include <string>

namespace softfinger {

/// How the writing of a file ended.
struct Exported {
  bool whole = false;  ///< false: something could not be written
  std::string lack;    ///< a line for people: what the recording did not allow; else empty
};

}  // namespace softfinger
