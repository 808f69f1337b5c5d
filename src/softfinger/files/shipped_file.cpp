#include "softfinger/files/shipped_file.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".toml";

struct ShippedRow {
  std::string_view one;  ///< with its article
  std::string_view folder;
};

ShippedRow row_of(Shipped kind) {
  switch (kind) {
    case Shipped::kScene:
      return {"a scene", "scenes"};
    case Shipped::kDevice:
      return {"a device", "devices"};
    case Shipped::kStudy:
      return {"a study", "studies"};
    case Shipped::kFinger:
      break;
  }
  return {"a finger", "fingers"};
}

/// Empty where there is none: bin/ and lib/ have share/ beside them, lib/x86_64-linux-gnu/ has it
/// one further up, a build tree and a Python package in themselves.
fs::path folder_of(Shipped kind) {
  const fs::path own = own_folder();
  std::error_code error;
  for (const char* up : {".", "..", "../.."}) {
    const fs::path folder = own / up / "share/softfinger" / row_of(kind).folder;
    if (fs::is_directory(folder, error)) return fs::canonical(folder, error);
  }
  return {};
}

bool is_name(std::string_view word) {
  return !word.empty() && word.find_first_of("/.") == std::string_view::npos;
}

/// A folder of that name is no file of that name: results/ and the like lie about everywhere.
bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::exists(file, error) && !fs::is_directory(file, error);
}

bool is_folder(const fs::path& file) {
  std::error_code error;
  return fs::is_directory(file, error);
}

[[noreturn]] void refuse(Shipped kind, std::string_view word, const fs::path& folder) {
  const ShippedRow row = row_of(kind);
  if (folder.empty()) {
    throw InputError(
        fmt::format("{}: no such file, and no share/softfinger/{} beside {}, where {} of that name "
                    "would be",
                    word, row.folder, own_folder().string(), row.one));
  }
  throw InputError(fmt::format("{}: no such file, nor {} of that name in {}, which has {}", word,
                               row.one, folder.string(),
                               fmt::join(names_near(word, shipped_names(kind)), ", ")));
}

}  // namespace

fs::path own_folder() {
  Dl_info info{};
  link_map* object = nullptr;
  std::error_code error;
  // A program has no name here; /proc has it even where it was found by PATH.
  if (::dladdr1(reinterpret_cast<const void*>(&own_folder), &info,
                reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) != 0 &&
      object != nullptr && object->l_name != nullptr && *object->l_name != '\0') {
    return fs::canonical(object->l_name, error).parent_path();
  }
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

fs::path file_or_shipped(Shipped kind, std::string_view word) {
  if (!is_name(word) || is_there(word)) return word;
  const fs::path folder = folder_of(kind);
  if (!folder.empty()) {
    fs::path file = folder / fmt::format("{}{}", word, kSuffix);
    if (is_there(file)) return file;
  }
  if (is_folder(word)) return word;  // whoever opens it says so
  refuse(kind, word, folder);
}

std::vector<std::string> shipped_names(Shipped kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_of(kind), error)) {
    if (entry.path().extension() == kSuffix) names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  return names;
}

std::vector<std::string> names_near(std::string_view word, const std::vector<std::string>& names) {
  std::vector<std::string> near;
  for (const std::string& name : names) {
    if (!word.empty() && name.find(word) != std::string::npos) near.push_back(name);
  }
  if (!near.empty()) return near;
  if (const std::string nearest = nearest_word(word, names); !nearest.empty()) return {nearest};
  return names;
}

}  // namespace softfinger
