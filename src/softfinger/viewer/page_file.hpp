#pragma once

#include <span>
#include <string_view>

namespace softfinger {

/// One file of the live page, held in the program.
struct PageFile {
  std::string_view path;          ///< as requested, e.g. "/index.html"
  std::string_view content_type;  ///< e.g. "text/css; charset=utf-8"
  std::string_view content;
};

/// The live page this library was built with. The program needs no files to show it.
[[nodiscard]] std::span<const PageFile> live_page();

/// The file a request target asks for: "/" is "/index.html", a query ("?...") is ignored. Null
/// where the page has no such file; only an exact path matches, so nothing else can be reached.
[[nodiscard]] const PageFile* find_page_file(std::span<const PageFile> page,
                                             std::string_view target);

}  // namespace softfinger
