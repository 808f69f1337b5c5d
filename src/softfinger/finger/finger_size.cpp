#include "softfinger/finger/finger_size.hpp"

#include <Eigen/Geometry>

#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {
namespace {

constexpr Range kSizes_mm{.min = FingerSize::kLeast / mm, .max = FingerSize::kGreatest / mm};

Vector3 skin_extent(const FingerModel& model) {
  Eigen::AlignedBox3d box;
  for (const int node : model.sample_nodes) {
    box.extend(model.mesh.nodes[static_cast<std::size_t>(node)]);
  }
  return box.sizes();
}

Vector3 mesh_extent(const FingerModel& model) {
  Eigen::AlignedBox3d box;
  for (const Vector3& node : model.mesh.nodes) box.extend(node);
  return box.sizes();
}

}  // namespace

FingerSize read_finger_size(const ConfigTable& table) {
  return {.length = table.optional_number("length_mm", kSizes_mm),
          .breadth = table.optional_number("breadth_mm", kSizes_mm),
          .depth = table.optional_number("depth_mm", kSizes_mm)};
}

FingerSize finger_size(const FingerModel& model) {
  const Vector3 extent = skin_extent(model);
  return {.length = extent.x(), .breadth = extent.y(), .depth = extent.z()};
}

Vector3 size_ratio(const FingerModel& from, const FingerModel& to) {
  return mesh_extent(to).cwiseQuotient(mesh_extent(from));
}

void resize(FingerModel& model, const FingerSize& size) {
  const Vector3 extent = skin_extent(model);
  Vector3 scale = Vector3::Ones();
  if (size.length) scale.x() = *size.length / extent.x();
  if (size.breadth) scale.y() = *size.breadth / extent.y();
  if (size.depth) scale.z() = *size.depth / extent.z();
  for (Vector3& node : model.mesh.nodes) node = node.cwiseProduct(scale);
}

}  // namespace softfinger
