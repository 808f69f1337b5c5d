#include "softfinger/c_interface/guard_beside_library.hpp"

#include <system_error>

#include "softfinger/files/shipped_file.hpp"

namespace softfinger {

std::filesystem::path guard_beside_library() {
  std::error_code error;
  // lib/, or lib/x86_64-linux-gnu/ where Debian has it.
  for (const char* programs : {".", "../bin", "../../bin"}) {
    std::filesystem::path guard = own_folder() / programs / "softfinger-guard";
    if (std::filesystem::exists(guard, error)) return std::filesystem::canonical(guard, error);
  }
  return {};
}

}  // namespace softfinger
