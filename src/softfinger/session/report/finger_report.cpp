#include "softfinger/session/report/finger_report.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "softfinger/base/units.hpp"
#include "softfinger/session/report/rounded.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

Json in_mm(const Vector3& metres) {
  return {micro_rounded(metres.x() / mm), micro_rounded(metres.y() / mm),
          micro_rounded(metres.z() / mm)};
}

Json mesh_statistics(const FingerModel& model) {
  const TetrahedralMesh& mesh = model.mesh;
  Eigen::AlignedBox3d box;
  double volume = 0.0, area = 0.0;
  for (const int node : model.sample_nodes) {
    box.extend(mesh.nodes[static_cast<std::size_t>(node)]);
  }
  for (const auto& tetrahedron : mesh.tetrahedra) {
    const auto arm = [&](std::size_t k) {
      return Vector3(mesh.nodes[static_cast<std::size_t>(tetrahedron[k])] -
                     mesh.nodes[static_cast<std::size_t>(tetrahedron[0])]);
    };
    volume += arm(1).cross(arm(2)).dot(arm(3)) / 6.0;
  }
  for (const double sample : model.sample_rest_areas) area += sample;
  const auto rigid = std::count(model.node_is_rigid.begin(), model.node_is_rigid.end(), true);
  return {{"tetrahedra", mesh.tetrahedra.size()},
          {"nodes", mesh.nodes.size()},
          {"rigid_nodes", rigid},
          {"skin_samples", model.sample_nodes.size()},
          {"skin_triangles", model.skin_triangles.size()},
          {"volumes", mesh.volume_names},
          {"surfaces", mesh.surface_names},
          {"skin_min_mm", in_mm(box.min())},
          {"skin_max_mm", in_mm(box.max())},
          {"skin_area_mm2", micro_rounded(area / mm2)},
          {"volume_mm3", micro_rounded(volume / (mm * mm2))}};
}

}  // namespace

Json finger_report(const FingerModel& model) {
  Json report = Json::parse(model.as_read);
  report["mesh_statistics"] = mesh_statistics(model);
  return report;
}

}  // namespace softfinger
