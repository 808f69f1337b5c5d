#include "softfinger/files/cache_folder.hpp"

#include <cstdlib>

namespace softfinger {

namespace fs = std::filesystem;

fs::path user_cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");  // NOLINT(concurrency-mt-unsafe)
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "softfinger";
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe)
  if (home != nullptr && fs::path(home).is_absolute()) {
    return fs::path(home) / ".cache" / "softfinger";
  }
  return {};
}

}  // namespace softfinger
