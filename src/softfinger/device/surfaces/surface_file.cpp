#include "softfinger/device/surfaces/surface_file.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/surfaces/piece_surface.hpp"
#include "softfinger/geometry/mesh_import.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/geometry/mesh_units.hpp"

namespace softfinger {
namespace {

const Range kSize{.min = 0.01, .max = 1000.0};           // mm
const Range kEdgeRounding = Range::between(0.02, 10.0);  // mm
constexpr double kDefaultEdge = 0.5 * mm;

/// Rounding of edges, at most `limit` (m).
double read_edge(const ConfigTable& table, double limit, const char* what) {
  const double edge =
      table.number("edge_radius_mm", Range::at_least(0.0), std::min(kDefaultEdge, limit));
  if (edge > limit * (1.0 + 1e-9)) {
    table.fail("edge_radius_mm", fmt::format("must be at most {}, {:.6g}, found {:.6g}", what,
                                             limit / mm, edge / mm));
  }
  return std::min(edge, limit);
}

/// By their names, as mesh_format() has them.
constexpr const char* kGltfName = "\\.([gG][lL][tT][fF]|[gG][lL][bB])$";
constexpr const char* kOtherMeshName = "\\.([oO][bB][jJ]|[sS][tT][lL]|[pP][lL][yY])$";

/// A ball in its place where it is not to be loaded.
Shape read_mesh(const ConfigTable& table, bool load) {
  const std::filesystem::path file = table.path("file");
  const std::string unit = table.choice("unit", names_of(kMeshUnits));
  MeshShapeOptions options;
  options.unit = row_named(kMeshUnits, unit)->value;
  options.edge_rounding = table.number("edge_rounding_mm", kEdgeRounding, options.edge_rounding);
  try {
    const MeshFormat format = mesh_format(file);
    const bool gltf = format == MeshFormat::kGltf || format == MeshFormat::kGlb;
    table.matches("file", gltf ? kGltfName : kOtherMeshName);
    if (gltf) table.decides("unit");
    if (gltf && unit != "m") table.fail("unit", "glTF and GLB are in metres: write \"m\"");
    if (!load) return Ball{options.edge_rounding};
    return load_mesh_shape(file, options);
  } catch (const InputError& error) {
    table.fail("file", error.what());
  }
}

PieceShape read_piece(const ConfigTable& table, const std::string& type, bool load) {
  if (type == "disk") {
    const double radius = table.number("radius_mm", kSize);
    return DiskPiece{radius, read_edge(table, std::min(radius, 1.0 * mm),
                                       "half the disk's thickness of 2 and radius_mm")};
  }
  if (type == "sphere") return Shape(Ball{table.number("radius_mm", kSize)});
  if (type == "capsule") {  // length: between the centres of its ends, along z
    const double radius = table.number("radius_mm", kSize);
    const double half_length = 0.5 * table.number("length_mm", kSize);
    return Shape(RoundedCylinder{radius, half_length + radius, radius});
  }
  if (type == "box") {
    const Vector3 half_size = 0.5 * table.numbers("size_mm", 3, kSize);
    return Shape(
        RoundedBox{half_size, read_edge(table, half_size.minCoeff(), "the least half size")});
  }
  return Shape(read_mesh(table, load));
}

/// Pins with their ends in the plane z = 0 of S: a grid about its origin, or a list of them.
void read_pins(const ConfigTable& table, const SurfacePiece& common,
               std::vector<SurfacePiece>& pieces) {
  const double radius = table.number("radius_mm", kSize);
  const auto add = [&](const Vector3& p_S) {
    SurfacePiece pin = common;
    pin.X_LS = common.X_LS * Pose{Matrix3::Identity(), p_S};
    pin.shape = PinPiece{radius};
    pieces.push_back(pin);
  };
  if (table.has("pin")) {
    const std::vector<ConfigTable> list = table.tables("pin");
    table.needs_one("pin");
    for (const ConfigTable& pin : list) add(pin.numbers("position_mm", 3));
    if (!list.empty()) return;
  }
  const int rows = table.integer("rows", 1, 64);
  const int columns = table.integer("columns", 1, 64);
  const double pitch = table.number("pitch_mm", kSize);
  if (static_cast<std::size_t>(rows * columns) > kMaxSurfacePieces) {
    table.fail("rows", fmt::format("{} pins; a mechanism has at most {} pieces of surface",
                                   rows * columns, kMaxSurfacePieces));
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      add(pitch * Vector3(row - 0.5 * (rows - 1), column - 0.5 * (columns - 1), 0.0));
    }
  }
}

}  // namespace

std::vector<SurfacePiece> read_surface(const ConfigTable& root,
                                       const std::vector<std::string>& bodies, bool load_meshes) {
  const std::vector<ConfigTable> tables = root.tables("surface");
  root.needs_one("surface");
  if (tables.empty()) {
    root.fail("surface", bodies.empty()
                             ? "nothing touches the finger: give what the drives move a [[surface]]"
                             : "nothing touches the finger: give a body a [[surface]]");
  }
  std::vector<SurfacePiece> pieces;
  for (const ConfigTable& table : tables) {
    const std::string type =
        table.choice("type", {"disk", "sphere", "capsule", "box", "pins", "mesh"});
    table.decides("type");
    SurfacePiece piece;
    if (!bodies.empty()) piece.body = read_name(table, "body", bodies, "body");
    piece.X_LS = read_frame(table);
    if (type == "pins") {
      read_pins(table, piece, pieces);
    } else {
      piece.shape = read_piece(table, type, load_meshes);
      pieces.push_back(piece);
    }
    if (pieces.size() > kMaxSurfacePieces) {
      table.fail("", fmt::format("with this there are {} pieces of surface; at most {}",
                                 pieces.size(), kMaxSurfacePieces));
    }
  }
  return pieces;
}

}  // namespace softfinger
