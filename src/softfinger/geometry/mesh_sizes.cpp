#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mesh_import.hpp"

namespace softfinger {
namespace {

std::uint32_t u32(const std::string& content, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<std::uint8_t>(content[at + k]);
  return value;
}

void refuse(std::string message) { throw MeshRefusal{std::move(message)}; }

/// "solid" begins text, but some binary files begin so as well: then the count is right.
void check_stl(const std::string& content) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  const bool text = content.starts_with("solid");
  if (content.size() < kHeader) {
    if (!text) refuse("is too short for STL");
    return;
  }
  const std::uint64_t count = u32(content, 80);
  const std::uint64_t size = kHeader + kTriangle * count;
  if (text && size != content.size()) return;
  if (size > content.size()) {
    refuse(fmt::format("its header announces {} triangles, {} bytes; it has {} bytes", count, size,
                       content.size()));
  }
  if (count > kMostTriangles) refuse(fmt::format("has more than {} triangles", kMostTriangles));
}

/// Each announced element takes a byte at least.
void check_ply(const std::string& content) {
  const std::size_t end = content.find("end_header");
  if (!content.starts_with("ply") || end == std::string::npos) refuse("cannot be read as PLY");
  std::string_view header(content.data(), end);
  while (!header.empty()) {
    std::string_view line = header.substr(0, header.find('\n'));
    header.remove_prefix(std::min(header.size(), line.size() + 1));
    if (!line.starts_with("element ")) continue;
    const std::size_t digits = line.find_last_not_of("\r \t");
    line = line.substr(0, digits + 1);
    const std::string_view number = line.substr(line.find_last_of(" \t") + 1);
    std::uint64_t count = 0;
    for (const char c : number) {
      if (c < '0' || c > '9' || count > kMostMeshBytes) refuse("cannot be read as PLY");
      count = 10 * count + static_cast<std::uint64_t>(c - '0');
    }
    if (count > content.size()) {
      refuse(
          fmt::format("its header announces {} elements; it has {} bytes", number, content.size()));
    }
  }
}

void check_gltf(const std::string& json_text) {
  const nlohmann::json json = nlohmann::json::parse(json_text, nullptr, false);
  if (!json.is_object()) refuse("cannot be read as glTF: its JSON is broken");
  const auto number = [](const nlohmann::json& object, const char* key) -> std::uint64_t {
    const auto value = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || value == object.end()) return 0;
    if (!value->is_number_integer() || *value < 0) {
      refuse(fmt::format("cannot be read as glTF: {} is no size", key));
    }
    return value->get<std::uint64_t>();
  };
  for (const char* list : {"accessors", "bufferViews", "buffers"}) {
    const auto entries = json.find(list);
    if (entries == json.end()) continue;
    for (const nlohmann::json& entry : *entries) {
      for (const char* key : {"count", "byteLength", "byteOffset", "byteStride"}) {
        if (number(entry, key) > kMostMeshBytes) {
          refuse(fmt::format("announces {} of {}, more than {}", key, number(entry, key),
                             kMostMeshBytes));
        }
      }
    }
  }
}

void check_glb(const std::string& content) {
  if (content.size() < 20 || !content.starts_with("glTF")) refuse("cannot be read as GLB");
  if (u32(content, 8) > content.size() || u32(content, 12) > content.size() - 20) {
    refuse(fmt::format("its header announces {} bytes; it has {}",
                       std::max(u32(content, 8), u32(content, 12)), content.size()));
  }
  check_gltf(content.substr(20, u32(content, 12)));
}

}  // namespace

MeshFormat mesh_format(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (extension == ".obj") return MeshFormat::kObj;
  if (extension == ".stl") return MeshFormat::kStl;
  if (extension == ".ply") return MeshFormat::kPly;
  if (extension == ".gltf") return MeshFormat::kGltf;
  if (extension == ".glb") return MeshFormat::kGlb;
  throw InputError(fmt::format("{}: not a mesh format; expected .obj, .stl, .ply, .gltf or .glb",
                               file.string()));
}

void check_announced_sizes(MeshFormat format, const std::string& content) {
  switch (format) {
    case MeshFormat::kObj:
      return;
    case MeshFormat::kStl:
      return check_stl(content);
    case MeshFormat::kPly:
      return check_ply(content);
    case MeshFormat::kGltf:
      return check_gltf(content);
    case MeshFormat::kGlb:
      return check_glb(content);
  }
}

}  // namespace softfinger
