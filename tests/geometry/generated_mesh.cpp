#include "generated_mesh.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <numbers>

#include "softfinger/geometry/vertex_weld.hpp"

namespace softfinger {
namespace {

void add(TriangleMesh& mesh, const Vector3& a, const Vector3& b, const Vector3& c) {
  const auto first = static_cast<int>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void add_quad(TriangleMesh& mesh, const Vector3& a, const Vector3& b, const Vector3& c,
              const Vector3& d) {
  add(mesh, a, b, c);
  add(mesh, a, c, d);
}

/// A parallelogram from `corner` along u and v, outward along u x v.
void add_face(TriangleMesh& mesh, const Vector3& corner, const Vector3& u, const Vector3& v,
              int n) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const auto at = [&](int di, int dj) -> Vector3 {
        return corner + (i + di) * u / n + (j + dj) * v / n;
      };
      add_quad(mesh, at(0, 0), at(1, 0), at(1, 1), at(0, 1));
    }
  }
}

TriangleMesh closed(const TriangleMesh& soup) { return welded(soup, 1e-9); }

template <typename T>
void put(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

struct Gltf {
  std::string json;
  std::string buffer;
};

Gltf gltf(const TriangleMesh& mesh, double unit, bool embedded) {
  Gltf result;
  Eigen::AlignedBox3d bounds;
  for (const Vector3& p : mesh.positions) {
    for (const double x : p) put(result.buffer, static_cast<float>(x / unit));
    bounds.extend(Vector3(p / unit));
  }
  const std::size_t positions = result.buffer.size();
  for (const auto& t : mesh.triangles) {
    for (const int vertex : t) put(result.buffer, static_cast<std::uint32_t>(vertex));
  }
  const std::string uri =
      embedded ? R"(,"uri":"data:application/octet-stream;base64,)" + base64(result.buffer) + "\""
               : "";
  result.json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
      R"("buffers":[{{"byteLength":{}{}}}],"bufferViews":[{{"buffer":0,"byteLength":{}}},)"
      R"({{"buffer":0,"byteOffset":{},"byteLength":{}}}],"accessors":[{{"bufferView":0,)"
      R"("componentType":5126,"count":{},"type":"VEC3","min":[{},{},{}],"max":[{},{},{}]}},)"
      R"({{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}]}})",
      result.buffer.size(), uri, positions, positions, result.buffer.size() - positions,
      mesh.positions.size(), bounds.min().x(), bounds.min().y(), bounds.min().z(), bounds.max().x(),
      bounds.max().y(), bounds.max().z(), 3 * mesh.triangles.size());
  return result;
}

std::string glb(const TriangleMesh& mesh, double unit) {
  Gltf parts = gltf(mesh, unit, false);
  while (parts.json.size() % 4 != 0) parts.json += ' ';
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(28 + parts.json.size() + parts.buffer.size()));
  put(bytes, static_cast<std::uint32_t>(parts.json.size()));
  bytes += "JSON" + parts.json;
  put(bytes, static_cast<std::uint32_t>(parts.buffer.size()));
  bytes += std::string("BIN\0", 4) + parts.buffer;
  return bytes;
}

}  // namespace

TriangleMesh sphere_mesh(double radius, int divisions) {
  const double g = std::numbers::phi;
  const Vector3 corners[12] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                               {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                               {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  TriangleMesh soup;
  for (const auto& face : faces) {
    const auto at = [&](int i, int j) -> Vector3 {
      const Vector3 flat =
          corners[face[0]] * (divisions - i - j) + corners[face[1]] * i + corners[face[2]] * j;
      return radius * flat.normalized();
    };
    for (int i = 0; i < divisions; ++i) {
      for (int j = 0; i + j < divisions; ++j) {
        add(soup, at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < divisions) add(soup, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return closed(soup);
}

TriangleMesh torus_mesh(double ring, double tube, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around;
      const double v = 2.0 * std::numbers::pi * j / across;
      const double rho = ring + tube * std::cos(v);
      mesh.positions.emplace_back(rho * std::cos(u), rho * std::sin(u), tube * std::sin(v));
      const int a = i * across + j;
      const int b = (i + 1) % around * across + j;
      const int c = (i + 1) % around * across + (j + 1) % across;
      const int d = i * across + (j + 1) % across;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

TriangleMesh box_mesh(const Vector3& half_size, int divisions) {
  TriangleMesh soup;
  for (int axis = 0; axis < 3; ++axis) {
    Vector3 u = Vector3::Zero();
    Vector3 v = Vector3::Zero();
    u[(axis + 1) % 3] = 2.0 * half_size[(axis + 1) % 3];
    v[(axis + 2) % 3] = 2.0 * half_size[(axis + 2) % 3];
    Vector3 corner = -half_size;
    add_face(soup, corner, v, u, divisions);
    corner[axis] = half_size[axis];
    add_face(soup, corner, u, v, divisions);
  }
  return closed(soup);
}

TriangleMesh tunnel_mesh(double half, double hole) {
  TriangleMesh soup;
  const auto at = [&](int k, double r, double z) -> Vector3 {
    const double x = k % 4 == 0 || k % 4 == 3 ? r : -r;
    const double y = k % 4 < 2 ? r : -r;
    return {x, y, z};
  };
  for (int k = 0; k < 4; ++k) {  // counter-clockwise seen from above
    add_quad(soup, at(k, half, -half), at(k + 1, half, -half), at(k + 1, half, half),
             at(k, half, half));
    add_quad(soup, at(k + 1, hole, -half), at(k, hole, -half), at(k, hole, half),
             at(k + 1, hole, half));
    add_quad(soup, at(k, half, half), at(k + 1, half, half), at(k + 1, hole, half),
             at(k, hole, half));
    add_quad(soup, at(k + 1, half, -half), at(k, half, -half), at(k, hole, -half),
             at(k + 1, hole, -half));
  }
  return closed(soup);
}

TriangleMesh wedge_mesh(double angle, double height, double half_length) {
  TriangleMesh soup;
  const double w = height * std::tan(0.5 * angle);
  const auto at = [&](double x, double z, double y) -> Vector3 { return {x, y, z}; };
  const double l = half_length;
  add_quad(soup, at(w, -height, -l), at(w, -height, l), at(0, 0, l), at(0, 0, -l));
  add_quad(soup, at(0, 0, -l), at(0, 0, l), at(-w, -height, l), at(-w, -height, -l));
  add_quad(soup, at(-w, -height, -l), at(-w, -height, l), at(w, -height, l), at(w, -height, -l));
  add(soup, at(w, -height, -l), at(0, 0, -l), at(-w, -height, -l));
  add(soup, at(w, -height, l), at(-w, -height, l), at(0, 0, l));
  return closed(soup);
}

TriangleMesh moved(TriangleMesh mesh, const Pose& X) {
  for (Vector3& p : mesh.positions) p = X * p;
  return mesh;
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh result = a;
  const auto first = static_cast<int>(a.positions.size());
  result.positions.insert(result.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles)
    result.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return result;
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  std::ofstream stream(file, std::ios::binary);
  stream << content;
}

void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh, double unit) {
  std::string text;
  const std::string extension = file.extension().string();
  if (extension == ".obj") {
    for (const Vector3& p : mesh.positions) {
      text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x() / unit, p.y() / unit, p.z() / unit);
    }
    for (const auto& t : mesh.triangles)
      text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  } else if (extension == ".ply") {
    text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.size(), mesh.triangles.size());
    for (const Vector3& p : mesh.positions) {
      text += fmt::format("{:.9g} {:.9g} {:.9g}\n", p.x() / unit, p.y() / unit, p.z() / unit);
    }
    for (const auto& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  } else if (extension == ".stl") {
    text = std::string(80, ' ');
    put(text, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) put(text, 0.0F);
      for (const int vertex : t) {
        for (const double x : mesh.positions[static_cast<std::size_t>(vertex)]) {
          put(text, static_cast<float>(x / unit));
        }
      }
      put(text, std::uint16_t{0});
    }
  } else if (extension == ".gltf") {
    text = gltf(mesh, unit, true).json;
  } else {
    text = glb(mesh, unit);
  }
  write_file(file, text);
}

}  // namespace softfinger
