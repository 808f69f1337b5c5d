// The fuzz targets without libFuzzer: one of them reads every file of a folder.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#define FUZZ_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inl"
#undef FUZZ_TARGET

namespace {

using Target = int (*)(const std::uint8_t*, std::size_t);

Target target_named(std::string_view wanted) {
#define FUZZ_TARGET(name) \
  if (wanted == #name) return fuzz_##name;
#include "fuzz_targets.inl"
#undef FUZZ_TARGET
  return nullptr;
}

}  // namespace

int main(int count, char** arguments) {
  const Target read = count == 3 ? target_named(arguments[1]) : nullptr;
  if (read == nullptr) {
    fmt::print(stderr, "fuzz_seeds TARGET FOLDER: expected a target and its seeds\n");
    return 2;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(arguments[2])) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
    read(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  fmt::print("{}: {} seeds read\n", arguments[1], files.size());
  return files.empty() ? 1 : 0;
}
