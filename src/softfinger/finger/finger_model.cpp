#include "softfinger/finger/finger_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
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

}  // namespace

std::shared_ptr<const FingerModel> FingerModel::load(const std::filesystem::path& file,
                                                     const FingerSize& person,
                                                     double modulus_factor) {
  return load(file, read_text_file(file, ConfigFile::kMaxSize), person, modulus_factor);
}

std::shared_ptr<const FingerModel> FingerModel::load(const std::filesystem::path& file,
                                                     const std::string& text,
                                                     const FingerSize& person,
                                                     double modulus_factor) {
  const ConfigFile config(file, text);
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
  model->measure();
  for (Material& material : model->materials) material.youngs_modulus *= modulus_factor;
  model->strain_limits.stiffness *= modulus_factor;
  root.finish();
  model->as_read = config.as_read();
  return model;
}

}  // namespace softfinger
