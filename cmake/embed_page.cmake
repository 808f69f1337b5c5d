# cmake -DPAGE=FOLDER -DOUTPUT=FILE.cpp -P embed_page.cmake
# Writes every file under PAGE as a constant, and softfinger::live_page() over all of them.
cmake_minimum_required(VERSION 3.25)
set(type_html "text/html; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_svg "image/svg+xml")
set(type_woff2 "font/woff2")
set(type_png "image/png")
set(type_json "application/json")
set(type_glb "model/gltf-binary")

string(REPEAT "[0-9a-f]" 64 line)
file(GLOB_RECURSE files RELATIVE ${PAGE} ${PAGE}/*)
list(SORT files)
if(NOT "index.html" IN_LIST files)
  message(FATAL_ERROR "${PAGE} has no index.html")
endif()
set(constants "")
set(entries "")
set(index 0)
foreach(name IN LISTS files)
  string(REGEX REPLACE ".*\\." "" extension "${name}")
  if(NOT DEFINED type_${extension})
    message(FATAL_ERROR "${name}: no content type is known for .${extension}; add it to embed_page.cmake")
  endif()
  file(SIZE ${PAGE}/${name} size)
  file(READ ${PAGE}/${name} content HEX)
  string(REGEX REPLACE "(${line})" "\\1\"\n\"" content "${content}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" content "${content}")
  string(APPEND constants "const char kFile${index}[] =\n\"${content}\";\n")
  string(APPEND entries "    {\"/${name}\", \"${type_${extension}}\", {kFile${index}, ${size}}},\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_page.cmake.
#include \"softfinger/viewer/page_file.hpp\"

namespace softfinger {
namespace {

${constants}
const PageFile kPage[] = {
${entries}};

}  // namespace

std::span<const PageFile> live_page() { return kPage; }

}  // namespace softfinger
")
