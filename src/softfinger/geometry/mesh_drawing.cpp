#include "softfinger/geometry/mesh_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "softfinger/base/stop_check.hpp"

namespace softfinger {
namespace {

TriangleMesh clustered(const TriangleMesh& mesh, const Vector3& origin, double cell,
                       StopCheck& check) {
  TriangleMesh result;
  std::unordered_map<std::uint64_t, int> numbers;
  std::vector<int> number(mesh.positions.size());
  std::vector<int> members;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    check();
    const Vector3 at = (mesh.positions[i] - origin) / cell;
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) key = key << 21 | static_cast<std::uint64_t>(at[k]);
    const auto [found, is_new] =
        numbers.try_emplace(key, static_cast<int>(result.positions.size()));
    if (is_new) {
      result.positions.push_back(Vector3::Zero());
      members.push_back(0);
    }
    number[i] = found->second;
    result.positions[static_cast<std::size_t>(found->second)] += mesh.positions[i];
    ++members[static_cast<std::size_t>(found->second)];
  }
  for (std::size_t i = 0; i < members.size(); ++i) result.positions[i] /= members[i];
  for (std::array<int, 3> t : mesh.triangles) {
    check();
    for (int& vertex : t) vertex = number[static_cast<std::size_t>(vertex)];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    result.triangles.push_back(t);
  }
  std::ranges::sort(result.triangles);
  result.triangles.erase(std::unique(result.triangles.begin(), result.triangles.end()),
                         result.triangles.end());
  return result;
}

}  // namespace

TriangleMesh drawing_of(const TriangleMesh& mesh, std::size_t most, const std::stop_token& stop) {
  StopCheck check(stop);
  if (mesh.triangles.size() <= most) return mesh;
  Eigen::AlignedBox3d bounds;
  for (const Vector3& p : mesh.positions) bounds.extend(p);
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](int k) -> const Vector3& {
      return mesh.positions[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  // About two triangles a cell; where that is not enough, larger cells.
  const double widest = bounds.sizes().maxCoeff();
  for (double cell = std::max(std::sqrt(2.0 * area / static_cast<double>(most)), 1e-6 * widest);;
       cell *= 1.1) {
    TriangleMesh result = clustered(mesh, bounds.min(), cell, check);
    if (result.triangles.size() <= most) return result;
  }
}

}  // namespace softfinger
