#include "folders.hpp"

namespace softfinger {

const std::string& source_folder() {
  static const std::string folder = SOFTFINGER_SOURCE_DIR;
  return folder;
}

const std::string& build_folder() {
  static const std::string folder = SOFTFINGER_BUILD_DIR;
  return folder;
}

const std::string& guard_program() {
  static const std::string program = build_folder() + "/softfinger-guard";
  return program;
}

}  // namespace softfinger
