#include "softfinger/study/loaded_module.hpp"

#include <dlfcn.h>

#include <system_error>

#include "softfinger/files/shipped_file.hpp"

namespace softfinger {

namespace fs = std::filesystem;

fs::path module_file(std::string_view name) {
  const fs::path own = own_folder();
  std::error_code error;
  for (const fs::path& folder :
       {own, own / "..", own / "softfinger", own / ".." / SOFTFINGER_LIBRARY_FOLDER / "softfinger",
        own / "../lib/softfinger", fs::path(SOFTFINGER_INSTALLED_MODULES)}) {
    if (fs::exists(folder / name, error)) return folder / name;
  }
  return {};
}

void* module_function(const fs::path& file, const char* name) {
  // Open MPI's own modules look for its symbols among all.
  void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
  return module == nullptr ? nullptr : ::dlsym(module, name);
}

}  // namespace softfinger
