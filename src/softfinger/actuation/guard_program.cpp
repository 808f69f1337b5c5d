#include "softfinger/actuation/guard_program.hpp"

#include <system_error>

namespace softfinger {

std::filesystem::path find_guard_program() {
  std::error_code error;
  const std::filesystem::path running = std::filesystem::read_symlink("/proc/self/exe", error);
  for (const std::filesystem::path& folder :
       {running.parent_path(), std::filesystem::path(SOFTFINGER_PROGRAMS)}) {
    std::filesystem::path guard = folder / "softfinger-guard";
    if (std::filesystem::exists(guard, error)) return guard;
  }
  return {};
}

}  // namespace softfinger
