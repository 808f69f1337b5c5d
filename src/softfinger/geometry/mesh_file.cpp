#include "softfinger/geometry/mesh_file.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/geometry/vertex_weld.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// Of the mesh's diagonal: below it two vertices of a seam are the same one, rounded twice.
constexpr double kSeam = 1e-6;

std::string percent_decoded(const std::string& uri) {
  std::string text;
  const auto digit = [](char c) {
    const std::string_view digits = "0123456789abcdef";
    return digits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) < 16 && digit(uri[i + 2]) < 16) {
      text += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

/// Names of the files that hold the buffers of a glTF file. Throws MeshRefusal.
std::vector<std::string> buffer_files(const std::string& json_text) {
  std::vector<std::string> names;
  const nlohmann::json json = nlohmann::json::parse(json_text, nullptr, false);
  if (!json.is_object() || !json.contains("buffers")) return names;
  for (const nlohmann::json& buffer : json.at("buffers")) {
    if (!buffer.is_object()) continue;
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    const auto text = uri->get<std::string>();
    if (text.starts_with("data:")) continue;
    const fs::path name = percent_decoded(text);
    if (name.is_absolute() || name.empty() || *name.lexically_normal().begin() == ".." ||
        text.find(':') != std::string::npos) {
      throw MeshRefusal{"names a buffer that is not in its folder"};
    }
    names.push_back(text);
  }
  return names;
}

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw MeshRefusal{"has no triangles"};
  for (const Vector3& p : mesh.positions) {
    if (!p.allFinite()) throw MeshRefusal{"has a coordinate that is not finite"};
  }
}

}  // namespace

MeshSource read_mesh_source(const fs::path& file, const std::stop_token& stop) {
  MeshSource source;
  source.file = file;
  source.format = mesh_format(file);
  const std::string name = file.filename().string();
  std::string content = read_text_file(file, kMostMeshBytes, stop);
  Hash hash;
  const auto add = [&hash](const std::string& bytes) {
    hash.add(static_cast<std::uint64_t>(bytes.size()));
    hash.add(std::span<const char>(bytes));
  };
  try {
    if (content.empty()) throw MeshRefusal{"is empty"};
    check_announced_sizes(source.format, content);
    add(content);
    if (source.format == MeshFormat::kGltf) {
      std::error_code error;
      const fs::path real = fs::canonical(file, error);  // buffers lie beside it, not beside a link
      for (const std::string& buffer : buffer_files(content)) {
        const auto [entry, is_new] = source.files.try_emplace(buffer);
        if (!is_new) continue;
        entry->second =
            read_text_file(real.parent_path() / percent_decoded(buffer), kMostMeshBytes, stop);
        add(entry->second);
      }
    }
  } catch (const MeshRefusal& refusal) {
    throw InputError(fmt::format("{}: {}", file.string(), refusal.message));
  }
  source.files[name] = std::move(content);
  source.hash = hash.value();
  return source;
}

TriangleMesh triangles_of(const MeshSource& source, double unit, const std::stop_token& stop) {
  try {
    TriangleMesh mesh = import_mesh_apart(source.format, source.file.filename().string(),
                                          source.files, {.longest = std::nullopt, .stop = stop});
    check(mesh);
    Eigen::AlignedBox3d bounds;
    for (Vector3& p : mesh.positions) {
      p *= unit;
      bounds.extend(p);
    }
    return welded(mesh, kSeam * bounds.diagonal().norm(), stop);
  } catch (const MeshRefusal& refusal) {
    throw InputError(fmt::format("{}: {}", source.file.string(), refusal.message));
  }
}

}  // namespace softfinger
