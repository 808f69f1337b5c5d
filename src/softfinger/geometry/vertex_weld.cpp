#include "softfinger/geometry/vertex_weld.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "softfinger/base/stop_check.hpp"

namespace softfinger {
namespace {

/// representative[i]: the vertex that stands for i; never larger than i.
using Representatives = std::vector<int>;

Representatives join_equal(const std::vector<Vector3>& positions, StopCheck& check) {
  std::vector<int> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const Vector3& p = positions[static_cast<std::size_t>(i)];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    check();
    return std::pair(key(a), a) < std::pair(key(b), b);
  });
  Representatives representative(positions.size());
  int first = -1;
  for (const int i : order) {
    check();
    if (first < 0 || key(first) != key(i)) first = i;
    representative[static_cast<std::size_t>(i)] = first;
  }
  return representative;
}

TriangleMesh joined(const TriangleMesh& mesh, const Representatives& representative,
                    StopCheck& check) {
  TriangleMesh result;
  std::vector<int> number(mesh.positions.size(), -1);
  result.triangles.reserve(mesh.triangles.size());
  for (std::array<int, 3> triangle : mesh.triangles) {
    check();
    for (int& vertex : triangle) vertex = representative[static_cast<std::size_t>(vertex)];
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      continue;
    }
    for (int& vertex : triangle) {
      int& own = number[static_cast<std::size_t>(vertex)];
      if (own < 0) {
        own = static_cast<int>(result.positions.size());
        result.positions.push_back(mesh.positions[static_cast<std::size_t>(vertex)]);
      }
      vertex = own;
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

/// Vertices of edges that one triangle alone has, in order.
std::vector<int> loose_vertices(const TriangleMesh& mesh, StopCheck& check) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) {
    check();
    return a < b;
  });
  std::vector<int> loose;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) {
      loose.push_back(edges[i].first);
      loose.push_back(edges[i].second);
    }
    i = end;
  }
  std::sort(loose.begin(), loose.end());
  loose.erase(std::unique(loose.begin(), loose.end()), loose.end());
  return loose;
}

/// Joins each loose vertex with the first one nearer than `tolerance`, found in cells of that size.
Representatives join_near(const TriangleMesh& mesh, const std::vector<int>& loose, double tolerance,
                          StopCheck& check) {
  using Cell = std::array<std::int64_t, 3>;
  const auto hash = [](const Cell& c) {
    return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
  };
  std::unordered_multimap<Cell, int, decltype(hash)> cells(2 * loose.size(), hash);
  Representatives representative(mesh.positions.size());
  std::iota(representative.begin(), representative.end(), 0);
  for (const int i : loose) {
    check();
    const Vector3& p = mesh.positions[static_cast<std::size_t>(i)];
    Cell cell;
    for (int k = 0; k < 3; ++k) {
      cell[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(p[k] / tolerance));
    }
    int first = i;
    for (int n = 0; n < 27; ++n) {
      const auto [begin, end] =
          cells.equal_range({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      for (auto at = begin; at != end; ++at) {
        const Vector3& other = mesh.positions[static_cast<std::size_t>(at->second)];
        if ((other - p).norm() <= tolerance) first = std::min(first, at->second);
      }
    }
    representative[static_cast<std::size_t>(i)] = first;
    if (first == i) cells.emplace(cell, i);
  }
  return representative;
}

}  // namespace

TriangleMesh welded(const TriangleMesh& mesh, double tolerance, const std::stop_token& stop) {
  StopCheck check(stop);
  TriangleMesh result = joined(mesh, join_equal(mesh.positions, check), check);
  const std::vector<int> loose = loose_vertices(result, check);
  if (loose.empty() || !(tolerance > 0.0)) return result;
  return joined(result, join_near(result, loose, tolerance, check), check);
}

}  // namespace softfinger
