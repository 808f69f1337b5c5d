#include "softfinger/finger/finger_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/finger/finger_groups.hpp"
#include "softfinger/geometry/msh_file.hpp"

namespace softfinger {
namespace {

constexpr double kLeastExtent = 1e-3;    // m; a mesh smaller or larger than a finger can be
constexpr double kGreatestExtent = 0.5;  // has the wrong unit

void load_mesh(const ConfigTable& table, FingerModel& model) {
  const MeshKeys keys = read_mesh_keys(table);
  model.mesh = read_msh(keys.file, keys.unit);
  Eigen::AlignedBox3d box;
  for (const Vector3& node : model.mesh.nodes) box.extend(node);
  const double extent = box.sizes().maxCoeff();
  if (extent < kLeastExtent || extent > kGreatestExtent) {
    table.fail("unit", fmt::format("the mesh is {:.3g} mm long in this unit, expected a finger of "
                                   "{:g} to {:g} mm",
                                   extent / mm, kLeastExtent / mm, kGreatestExtent / mm));
  }
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

/// Tetrahedra that move with the bone as a whole are none of the tissue.
void find_shares(FingerModel& model) {
  double all = 0.0;
  for (std::size_t t = 0; t < model.mesh.tetrahedra.size(); ++t) {
    const int material = model.tetrahedron_material[t];
    if (material < 0) continue;
    std::array<Vector3, 4> corners;
    bool soft = false;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(model.mesh.tetrahedra[t][k]);
      corners[k] = model.mesh.nodes[node];
      soft = soft || !model.node_is_rigid[node];
    }
    if (!soft) continue;
    const double volume =
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]) / 6.0;
    model.materials[static_cast<std::size_t>(material)].share += volume;
    all += volume;
  }
  for (FingerModel::Material& material : model.materials) material.share /= all;
}

}  // namespace

double FingerModel::plane_modulus() const {
  double modulus = 0.0;
  for (const Material& material : materials) {
    const double nu = material.poissons_ratio;
    modulus += material.share * material.youngs_modulus / (1.0 - nu * nu);
  }
  return modulus;
}

std::shared_ptr<const FingerModel> FingerModel::load(const std::filesystem::path& file,
                                                     const FingerSize& person) {
  const ConfigFile config(file);
  const ConfigTable root = config.root();
  auto model = std::make_shared<FingerModel>();
  model->file = file;
  const ConfigTable mesh = root.table("mesh");
  load_mesh(mesh, *model);
  const FingerSize own = read_constants(root, *model);

  FingerGroups groups = group_nodes(model->mesh);
  if (!groups.defect.empty()) mesh.fail("file", mesh.text("file") + ": " + groups.defect);
  model->sample_nodes = std::move(groups.sample_nodes);
  model->skin_triangles = std::move(groups.skin_triangles);
  model->node_is_rigid = std::move(groups.node_is_rigid);
  resize(*model, {.length = person.length ? person.length : own.length,
                  .breadth = person.breadth ? person.breadth : own.breadth,
                  .depth = person.depth ? person.depth : own.depth});
  model->sample_rest_areas = sample_areas(*model);
  find_shares(*model);
  root.finish();
  model->as_read = config.as_read();
  return model;
}

}  // namespace softfinger
