#include "softfinger/export/mcap/skin_pressure.hpp"

#include <limits>

namespace softfinger {

std::vector<double> skin_pressures(const FingerModel* model,
                                   const std::vector<SampleRecord>& samples) {
  std::vector<double> pressures(samples.size(), std::numeric_limits<double>::quiet_NaN());
  if (model == nullptr || model->sample_nodes.size() != samples.size()) return pressures;
  std::vector<Vector3> areas_F(samples.size(), Vector3::Zero());
  for (const std::array<int, 3>& triangle : model->skin_triangles) {
    const auto corner = [&](int k) -> const Vector3& {
      return samples[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])].position_F;
    };
    const Vector3 area_F = (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2.0;
    for (const int sample : triangle) areas_F[static_cast<std::size_t>(sample)] += area_F / 3.0;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double squared = areas_F[i].squaredNorm();
    if (squared > 0.0) pressures[i] = -samples[i].force_F.dot(areas_F[i]) / squared + 0.0;
  }
  return pressures;
}

}  // namespace softfinger
