#include "softfinger/geometry/mesh_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
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

TriangleMesh drawing_of(const TaperedCapsule& capsule) {
  constexpr int kAround = 16;
  constexpr int kRings = 5;  // of each end
  const double lean = (capsule.back - capsule.front) / (2.0 * capsule.half_length);
  const double seam = std::acos(lean);  // where the cone meets the balls, from +x
  TriangleMesh mesh;
  const auto add_ring = [&](double centre, double radius, double angle) {
    for (int a = 0; a < kAround; ++a) {
      const double turn = 2.0 * std::numbers::pi * a / kAround;
      mesh.positions.emplace_back(centre + radius * std::cos(angle),
                                  radius * std::sin(angle) * std::cos(turn),
                                  radius * std::sin(angle) * std::sin(turn));
    }
  };
  mesh.positions.emplace_back(-capsule.half_length - capsule.back, 0.0, 0.0);
  for (int k = 1; k <= kRings; ++k) {
    const double angle = std::numbers::pi + (seam - std::numbers::pi) * k / kRings;
    add_ring(-capsule.half_length, capsule.back, angle);
  }
  for (int k = kRings; k > 0; --k) {
    add_ring(capsule.half_length, capsule.front, seam * k / kRings);
  }
  mesh.positions.emplace_back(capsule.half_length + capsule.front, 0.0, 0.0);
  const auto at = [](int ring, int a) { return 1 + ring * kAround + a % kAround; };
  const int last = 2 * kRings - 1;
  for (int a = 0; a < kAround; ++a) {
    mesh.triangles.push_back({0, at(0, a + 1), at(0, a)});
    for (int ring = 0; ring < last; ++ring) {
      mesh.triangles.push_back({at(ring, a), at(ring, a + 1), at(ring + 1, a)});
      mesh.triangles.push_back({at(ring, a + 1), at(ring + 1, a + 1), at(ring + 1, a)});
    }
    mesh.triangles.push_back({at(last, a), at(last, a + 1), at(last + 1, 0)});
  }
  return mesh;
}

}  // namespace softfinger
