#include "softfinger/finger/finger_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>

#include "softfinger/base/config_file.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_groups.hpp"
#include "softfinger/geometry/msh_file.hpp"

namespace softfinger {
namespace {

constexpr double kLeastExtent = 1e-3;    // m; a mesh smaller or larger than a finger can be
constexpr double kGreatestExtent = 0.5;  // has the wrong unit

void read_mesh(const ConfigTable& table, FingerModel& model) {
  const std::filesystem::path file = table.path("file");
  const bool metres = table.choice("unit", {"mm", "m"}, "mm") == "m";
  model.mesh = read_msh(file, metres ? 1.0 : mm);
  Eigen::AlignedBox3d box;
  for (const Vector3& node : model.mesh.nodes) box.extend(node);
  const double extent = box.sizes().maxCoeff();
  if (extent < kLeastExtent || extent > kGreatestExtent) {
    table.fail("unit", fmt::format("the mesh is {:.3g} mm long in this unit, expected a finger of "
                                   "{:g} to {:g} mm",
                                   extent / mm, kLeastExtent / mm, kGreatestExtent / mm));
  }
}

std::ptrdiff_t soft_volume_count(const TetrahedralMesh& mesh) {
  return std::count_if(mesh.volume_names.begin(), mesh.volume_names.end(),
                       [](const std::string& name) { return name != kBoneGroup; });
}

/// What a volume has where it gives no constants of its own. Nothing stands in for Young's modulus
/// and Poisson's ratio of one among several volumes.
struct CommonMaterial {
  std::optional<double> youngs_modulus, poissons_ratio;
  double density = FingerModel::Material{}.density;
};

constexpr Range kBelowHalf{.min = 0.0, .max = 0.5, .open_max = true};

CommonMaterial read_common_material(const ConfigTable& table, bool is_of_several) {
  CommonMaterial common;
  if (is_of_several) {
    common.youngs_modulus = table.optional_number("youngs_modulus_kPa", Range::positive());
    common.poissons_ratio = table.optional_number("poissons_ratio", kBelowHalf);
  } else {
    const FingerModel::Material usual;
    common.youngs_modulus =
        table.number("youngs_modulus_kPa", Range::positive(), usual.youngs_modulus);
    common.poissons_ratio = table.number("poissons_ratio", kBelowHalf, usual.poissons_ratio);
  }
  common.density = table.number("density_kg_per_m3", Range::positive(), common.density);
  return common;
}

/// Constants of one volume: its own table `material.volume`, else those of [material].
FingerModel::Material read_material(const ConfigTable& table, const std::string& volume,
                                    const CommonMaterial& common) {
  const auto own = volume.empty() ? std::nullopt : table.optional_table(volume);
  if (!own) {
    if (common.youngs_modulus && common.poissons_ratio) {
      return {volume, *common.youngs_modulus, *common.poissons_ratio, common.density};
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
  return {volume, number("youngs_modulus_kPa", Range::positive(), common.youngs_modulus),
          number("poissons_ratio", kBelowHalf, common.poissons_ratio),
          number("density_kg_per_m3", Range::positive(), common.density)};
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

void read_materials(const ConfigTable& table, FingerModel& model) {
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

void read_strain_limits(const ConfigTable& table, FingerModel::StrainLimits& limits) {
  limits.enabled = true;
  limits.min = table.number("min", Range::inside(0.0, 1.0), limits.min);
  limits.max = table.number("max", Range{.min = 1.0, .max = 10.0, .open_min = true}, limits.max);
  limits.stiffness = table.number("stiffness_kPa", Range::positive(), limits.stiffness);
  const double widest = std::min(1.0 - limits.min, limits.max - 1.0);
  limits.width = table.number("width", Range::positive(), std::min(limits.width, widest));
  if (limits.width > widest * (1.0 + 1e-9)) {
    table.fail("width",
               fmt::format("must be at most {:.6g}, the lesser of 1 - min and max - 1, else "
                           "the skin is stressed at rest; found {}",
                           widest, limits.width));
  }
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

std::vector<double> sample_areas(const FingerModel& model) {
  std::vector<double> areas(model.sample_nodes.size(), 0.0);
  for (const auto& triangle : model.skin_triangles) {
    std::array<Vector3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = model.sample_nodes[static_cast<std::size_t>(triangle[k])];
      corners[k] = model.mesh.nodes[static_cast<std::size_t>(node)];
    }
    const double area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    for (const int sample : triangle) areas[static_cast<std::size_t>(sample)] += area / 3.0;
  }
  return areas;
}

}  // namespace

std::shared_ptr<const FingerModel> FingerModel::load(const std::filesystem::path& file,
                                                     const FingerSize& person) {
  const ConfigFile config(file);
  const ConfigTable root = config.root();
  auto model = std::make_shared<FingerModel>();
  model->file = file;
  const ConfigTable mesh = root.table("mesh");
  read_mesh(mesh, *model);
  if (soft_volume_count(model->mesh) > 1 && !root.has("material")) {
    mesh.fail("file", fmt::format("{} has several physical volumes, {}: give each its constants in "
                                  "[material.NAME], or all of them in [material]",
                                  mesh.text("file"), fmt::join(model->mesh.volume_names, ", ")));
  }
  read_materials(root.table_or_empty("material"), *model);
  if (const auto limits = root.optional_table("strain_limits")) {
    read_strain_limits(*limits, model->strain_limits);
  }
  model->bone_mass =
      root.table_or_empty("bone").number("mass_g", Range::positive(), model->bone_mass);
  read_coupling(root.table_or_empty("coupling"), model->coupling);
  const ConfigTable contact = root.table_or_empty("contact");
  model->contact_tolerance =
      contact.number("tolerance_mm", Range::between(0.0, 5.0), model->contact_tolerance);
  model->friction_coefficient = contact.number("friction_coefficient", Range::between(0.0, 10.0),
                                               model->friction_coefficient);
  model->feature_contact = contact.boolean("features", model->feature_contact);
  FingerSize own;
  if (const auto size = root.optional_table("size")) own = read_finger_size(*size);

  FingerGroups groups = group_nodes(model->mesh);
  if (!groups.defect.empty()) mesh.fail("file", mesh.text("file") + ": " + groups.defect);
  model->sample_nodes = std::move(groups.sample_nodes);
  model->skin_triangles = std::move(groups.skin_triangles);
  model->node_is_rigid = std::move(groups.node_is_rigid);
  resize(*model, {.length = person.length ? person.length : own.length,
                  .breadth = person.breadth ? person.breadth : own.breadth,
                  .depth = person.depth ? person.depth : own.depth});
  model->sample_rest_areas = sample_areas(*model);
  root.finish();
  model->as_read = config.as_read();
  return model;
}

}  // namespace softfinger
