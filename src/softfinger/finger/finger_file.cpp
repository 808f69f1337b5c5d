#include "softfinger/finger/finger_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_groups.hpp"

namespace softfinger {
namespace {

std::ptrdiff_t soft_volume_count(const TetrahedralMesh& mesh) {
  return std::count_if(mesh.volume_names.begin(), mesh.volume_names.end(),
                       [](const std::string& name) { return name != kBoneGroup; });
}

/// What a volume has where it gives no constants of its own. Nothing stands in for Young's modulus
/// and Poisson's ratio of one among several volumes.
struct CommonMaterial {
  std::optional<double> youngs_modulus, poissons_ratio;
  double density = SoftSolid::Material{}.density;
};

/// Of strain limits whose table names none, Pa.
constexpr double kLimitStiffness = 40e3;

constexpr Range kBelowHalf{.min = 0.0, .max = 0.5, .open_max = true};

CommonMaterial read_common_material(const ConfigTable& table, bool is_of_several) {
  CommonMaterial common;
  if (is_of_several) {
    common.youngs_modulus = table.optional_number("youngs_modulus_kPa", Range::positive());
    common.poissons_ratio = table.optional_number("poissons_ratio", kBelowHalf);
  } else {
    const SoftSolid::Material usual;
    common.youngs_modulus =
        table.number("youngs_modulus_kPa", Range::positive(), usual.youngs_modulus);
    common.poissons_ratio = table.number("poissons_ratio", kBelowHalf, usual.poissons_ratio);
  }
  common.density = table.number("density_kg_per_m3", Range::positive(), common.density);
  return common;
}

/// Constants of one volume: its own table `material.volume`, else those of [material].
SoftSolid::Material read_material(const ConfigTable& table, const std::string& volume,
                                  const CommonMaterial& common) {
  const auto own = volume.empty() ? std::nullopt : table.optional_table(volume);
  if (!volume.empty()) table.any_name(volume);
  if (!own) {
    if (common.youngs_modulus && common.poissons_ratio) {
      return {{*common.youngs_modulus, *common.poissons_ratio, common.density}, volume};
    }
    const std::string missing = common.youngs_modulus ? "poissons_ratio" : "youngs_modulus_kPa";
    if (volume.empty()) {
      table.fail(missing,
                 "missing; some tetrahedra are in no physical volume, so that nothing "
                 "else can give it");
    }
    table.fail(volume, fmt::format("missing; one of several physical volumes of the mesh, it needs "
                                   "{} here or in [material]",
                                   missing));
  }
  const auto number = [&](std::string_view key, Range range, std::optional<double> fallback) {
    return fallback ? own->number(key, range, *fallback) : own->number(key, range);
  };
  return {{number("youngs_modulus_kPa", Range::positive(), common.youngs_modulus),
           number("poissons_ratio", kBelowHalf, common.poissons_ratio),
           number("density_kg_per_m3", Range::positive(), common.density)},
          volume};
}

Relaxation read_relaxation(const ConfigTable& material) {
  Relaxation relaxation;
  const Range below_one{.min = 0.0, .max = 1.0, .open_min = true, .open_max = true};
  for (const ConfigTable& table : material.tables("relaxation")) {
    Relaxation::Term term{};
    term.time = table.number("time_ms", Range::between(0.1, 1e5));
    term.fraction = table.number("fraction", below_one);
    relaxation.terms.push_back(term);
    if (relaxation.long_time_fraction() <= 0.0) {
      table.fail("fraction", fmt::format("the fractions of all [[material.relaxation]] must sum to "
                                         "less than 1, found {:.6g}",
                                         1.0 - relaxation.long_time_fraction()));
    }
  }
  return relaxation;
}

void read_coupling(const ConfigTable& table, Coupling& coupling) {
  coupling.translation_stiffness =
      table.number("translation_N_per_mm", Range::positive(), coupling.translation_stiffness);
  coupling.translation_damping =
      table.number("translation_N_s_per_mm", Range::at_least(0.0), coupling.translation_damping);
  coupling.rotation_stiffness =
      table.number("rotation_N_mm_per_rad", Range::positive(), coupling.rotation_stiffness);
  coupling.rotation_damping =
      table.number("rotation_N_mm_s_per_rad", Range::at_least(0.0), coupling.rotation_damping);
}

/// A table for each of two volumes: their keys, all of which [material] may have instead.
constexpr const char* kExample = R"toml(
[mesh]
file = "index.msh"
[material]
youngs_modulus_kPa = 45.0
poissons_ratio = 0.4
[material.epidermis]
[material.dermis]
[[material.relaxation]]
time_ms = 100.0
fraction = 0.5
[strain_limits]
[size]
)toml";

}  // namespace

void read_materials(const ConfigTable& table, SoftSolid& model) {
  const TetrahedralMesh& mesh = model.mesh;
  const CommonMaterial common = read_common_material(table, soft_volume_count(mesh) > 1);
  const std::vector<std::string> own_keys{"youngs_modulus_kPa", "poissons_ratio",
                                          "density_kg_per_m3", "dilatation", "relaxation"};
  model.relaxation = read_relaxation(table);
  model.dilatation = table.choice("dilatation", {"element", "patch"}, "element") == "patch"
                         ? Dilatation::kPatch
                         : Dilatation::kElement;
  for (const std::string& key : table.keys()) {
    const bool is_volume = std::find(mesh.volume_names.begin(), mesh.volume_names.end(), key) !=
                           mesh.volume_names.end();
    if (is_volume && key == kBoneGroup) table.fail(key, "the volume 'bone' is rigid: no material");
    const bool is_own = std::find(own_keys.begin(), own_keys.end(), key) != own_keys.end();
    if (is_volume || is_own) continue;
    const std::string meant = nearest_word(key, own_keys);
    table.fail(key, meant.empty()
                        ? fmt::format("the mesh has no physical volume of this name; it has: {}",
                                      fmt::join(mesh.volume_names, ", "))
                        : fmt::format("unknown key '{}'; did you mean '{}'?", key, meant));
  }
  std::vector<int> material_of_volume;
  for (const std::string& volume : mesh.volume_names) {
    if (volume == kBoneGroup) {
      material_of_volume.push_back(-1);
      continue;
    }
    material_of_volume.push_back(static_cast<int>(model.materials.size()));
    model.materials.push_back(read_material(table, volume, common));
  }
  for (const int volume : mesh.tetrahedron_volume) {
    model.tetrahedron_material.push_back(material_of_volume[static_cast<std::size_t>(volume)]);
  }
}

void read_strain_limits(const ConfigTable& table, StrainLimit& limits) {
  limits.min = table.number("min", Range::inside(0.0, 1.0), limits.min);
  limits.max = table.number("max", Range{.min = 1.0, .max = 10.0, .open_min = true}, limits.max);
  limits.stiffness = table.number("stiffness_kPa", Range::positive(), kLimitStiffness);
  const double widest = std::min(1.0 - limits.min, limits.max - 1.0);
  limits.width = table.number("width", Range::positive(), std::min(limits.width, widest));
  if (limits.width > widest * (1.0 + 1e-9)) {
    table.fail("width",
               fmt::format("must be at most {:.6g}, the lesser of 1 - min and max - 1, else "
                           "the skin is stressed at rest; found {}",
                           widest, limits.width));
  }
}

MeshKeys read_mesh_keys(const ConfigTable& table) {
  MeshKeys keys;
  keys.file = table.path("file");
  keys.unit = table.choice("unit", {"mm", "m"}, "mm") == "m" ? 1.0 : mm;
  return keys;
}

FingerSize read_constants(const ConfigTable& root, FingerModel& model) {
  if (soft_volume_count(model.mesh) > 1 && !root.has("material")) {
    const ConfigTable mesh = root.table("mesh");
    mesh.fail("file", fmt::format("{} has several physical volumes, {}: give each its constants in "
                                  "[material.NAME], or all of them in [material]",
                                  mesh.text("file"), fmt::join(model.mesh.volume_names, ", ")));
  }
  read_materials(root.table_or_empty("material"), model);
  if (const auto limits = root.optional_table("strain_limits")) {
    read_strain_limits(*limits, model.strain_limits);
  }
  model.bone_mass =
      root.table_or_empty("bone").number("mass_g", Range::positive(), model.bone_mass);
  read_coupling(root.table_or_empty("coupling"), model.coupling);
  const ConfigTable contact = root.table_or_empty("contact");
  model.contact_tolerance =
      contact.number("tolerance_mm", Range::between(0.0, 5.0), model.contact_tolerance);
  model.friction_coefficient =
      contact.number("friction_coefficient", Range::between(0.0, 10.0), model.friction_coefficient);
  model.feature_contact = contact.boolean("features", model.feature_contact);
  const auto size = root.optional_table("size");
  return size ? read_finger_size(*size) : FingerSize{};
}

std::string finger_schema() {
  const ConfigFile config("finger.toml", kExample);
  const ConfigTable root = config.root();
  FingerModel model;
  model.mesh.volume_names = {"epidermis", "dermis"};
  static_cast<void>(read_mesh_keys(root.table("mesh")));
  static_cast<void>(read_constants(root, model));
  root.finish();
  return config.schema("softfinger finger file");
}

}  // namespace softfinger
