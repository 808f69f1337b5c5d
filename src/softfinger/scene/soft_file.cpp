#include "softfinger/scene/soft_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/finger/finger_groups.hpp"
#include "softfinger/geometry/msh_file.hpp"

namespace softfinger {
namespace {

constexpr double kLeastExtent = 1e-3;    // m; what is smaller or larger has
constexpr double kGreatestExtent = 2.0;  // the wrong unit
constexpr std::size_t kMostTetrahedra = 20000;
// What is softer tangles under its own weight, what is harder is rigid, and steps of either may not
// converge.
const Range kSoftModulus = Range::between(0.5, 1e5);   // kPa
const Range kSoftDensity = Range::between(10.0, 2e4);  // kg/m^3

void load_mesh(const ConfigTable& table, const std::filesystem::path& file, double unit,
               SoftSolid& solid) {
  const auto fail = [&](const std::string& message) {
    table.fail("file", fmt::format("{}: {}", table.text("file"), message));
  };
  try {
    solid.mesh = read_msh(file, unit);
  } catch (const InputError& error) {
    table.fail("file", error.what());
  }
  if (solid.mesh.tetrahedra.size() > kMostTetrahedra) {
    fail(fmt::format("{} tetrahedra; at most {}", solid.mesh.tetrahedra.size(), kMostTetrahedra));
  }
  Eigen::AlignedBox3d box;
  for (const Vector3& node : solid.mesh.nodes) box.extend(node);
  const double extent = box.sizes().maxCoeff();
  if (extent < kLeastExtent || extent > kGreatestExtent) {
    table.fail("unit",
               fmt::format("the mesh is {:.6g} mm long in this unit, expected {:g} to {:g} mm",
                           extent / mm, kLeastExtent / mm, kGreatestExtent / mm));
  }
  if (!is_one_piece(solid.mesh)) fail("the tetrahedra are in several pieces; make each an object");
  SampledSurface surface = sampled_surface(solid.mesh, SoftSolid::kTouchingGroup);
  if (!surface.defect.empty()) fail(surface.defect);
  solid.sample_nodes = std::move(surface.sample_nodes);
  solid.skin_triangles = std::move(surface.triangles);
  solid.node_is_rigid.assign(solid.mesh.nodes.size(), false);
  mark_surface(solid.mesh, SoftSolid::kHeldGroup, solid.node_is_rigid);
  if (std::ranges::find(solid.node_is_rigid, false) == solid.node_is_rigid.end()) {
    fail("all nodes are of group 'fixed': nothing is left to deform");
  }
}

/// Of each volume, wherever it was given.
void check_ranges(const ConfigTable& material, const SoftSolid& solid) {
  for (const SoftSolid::Material& of : solid.materials) {
    const ConfigTable own = of.volume.empty() ? material : material.table_or_empty(of.volume);
    const auto check = [&](const char* key, double value, const Range& range) {
      if (value >= range.min && value <= range.max) return;
      (own.has(key) ? own : material)
          .fail(key, fmt::format("must be {:g} to {:g} of a soft object, found {:g}", range.min,
                                 range.max, value));
    };
    check("youngs_modulus_kPa", of.youngs_modulus / kPa, kSoftModulus);
    check("density_kg_per_m3", of.density, kSoftDensity);
  }
}

}  // namespace

std::shared_ptr<const SoftSolid> read_soft(const ConfigTable& table, bool with_file) {
  auto solid = std::make_shared<SoftSolid>();
  const std::filesystem::path file = table.path("file");
  table.matches("file", "\\.[mM][sS][hH]$");
  const double unit = table.choice("unit", {"mm", "m"}) == "m" ? 1.0 : mm;
  solid->file = file;
  if (with_file) {
    load_mesh(table, file, unit, *solid);
  } else {
    solid->mesh.volume_names = {"foam"};
  }
  const ConfigTable material = table.table("material");
  if (solid->mesh.volume_names.size() <= 1) {
    // Those of a finger are not a sponge's.
    (void)material.number("youngs_modulus_kPa", kSoftModulus);
    (void)material.number("poissons_ratio", Range{.min = 0.0, .max = 0.5, .open_max = true});
    (void)material.number("density_kg_per_m3", kSoftDensity);
  }
  read_materials(material, *solid);
  check_ranges(material, *solid);
  if (const auto limits = table.optional_table("strain_limits")) {
    read_strain_limits(*limits, solid->strain_limits);
  } else {
    solid->strain_limits = solid->densification();
  }
  if (with_file) {
    if (std::ranges::find(solid->tetrahedron_material, -1) != solid->tetrahedron_material.end()) {
      table.fail("file", fmt::format("{}: a soft object has no volume 'bone'", table.text("file")));
    }
    solid->measure();
  }
  return solid;
}

}  // namespace softfinger
