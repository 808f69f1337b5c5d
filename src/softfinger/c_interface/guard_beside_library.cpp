#include "softfinger/c_interface/guard_beside_library.hpp"

#include <dlfcn.h>

#include <system_error>

#include "softfinger/softfinger.h"

namespace softfinger {

std::filesystem::path guard_beside_library() {
  Dl_info library{};
  if (::dladdr(reinterpret_cast<const void*>(&sf_version), &library) == 0) return {};
  std::error_code error;
  const std::filesystem::path folder =
      std::filesystem::canonical(library.dli_fname, error).parent_path();
  // lib/, or lib/x86_64-linux-gnu/ where Debian has it.
  for (const char* programs : {".", "../bin", "../../bin"}) {
    std::filesystem::path guard = folder / programs / "softfinger-guard";
    if (std::filesystem::exists(guard, error)) return std::filesystem::canonical(guard, error);
  }
  return {};
}

}  // namespace softfinger
