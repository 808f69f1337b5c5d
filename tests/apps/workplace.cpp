#include "workplace.hpp"
#include "../support/folders.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>

namespace softfinger {

namespace fs = std::filesystem;

Workplace::Workplace() {
  std::string pattern = testing::TempDir() + "softfinger-workplace-XXXXXX";
  folder_ = mkdtemp(pattern.data());
  const fs::path tree = source_folder();
  for (const char* kind : {"devices", "scenes"}) fs::copy(tree / kind, folder_ / kind);
  fs::create_directory(folder_ / "fingers");
  for (const char* file : {"index.toml", "index.msh", "index-medium.toml", "index-medium.msh"}) {
    fs::copy(tree / "fingers" / file, folder_ / "fingers" / file);
  }
}

Workplace::~Workplace() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Workplace::write(const std::string& file, std::string_view text) const {
  std::ofstream(folder_ / file, std::ios::binary) << text;
}

std::string Workplace::read(const std::string& file) const {
  std::ifstream in(folder_ / file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int Workplace::replace_line(const std::string& file, std::string_view begin,
                            std::string_view line) const {
  std::istringstream in(read(file));
  std::string text;
  int number = 0;
  int found = 0;
  for (std::string old; std::getline(in, old);) {
    ++number;
    if (found == 0 && old.starts_with(begin)) {
      found = number;
      old = line;
    }
    text += old + "\n";
  }
  EXPECT_NE(found, 0) << file << " has no line that starts with " << begin;
  write(file, text);
  return found;
}

}  // namespace softfinger
