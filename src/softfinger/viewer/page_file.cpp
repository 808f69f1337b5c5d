#include "softfinger/viewer/page_file.hpp"

#include <algorithm>

namespace softfinger {

const PageFile* find_page_file(std::span<const PageFile> page, std::string_view target) {
  std::string_view path = target.substr(0, target.find_first_of("?#"));
  if (path == "/") path = "/index.html";
  const auto found = std::ranges::find(page, path, &PageFile::path);
  return found == page.end() ? nullptr : &*found;
}

}  // namespace softfinger
