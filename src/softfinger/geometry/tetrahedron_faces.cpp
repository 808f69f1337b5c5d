#include "softfinger/geometry/tetrahedron_faces.hpp"

#include <algorithm>

namespace softfinger {
namespace {

/// A directed edge a -> b of the boundary triangle, seen from the third node or by itself.
struct BoundaryEdge {
  int from, to, opposite, tetrahedron;
};

std::vector<BoundaryEdge> boundary_edges(std::span<const TetrahedronFace> faces) {
  std::vector<BoundaryEdge> edges;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    if (end == i + 1) {
      const Triangle& t = faces[i].outward;
      for (std::size_t k = 0; k < 3; ++k) {
        edges.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3], faces[i].tetrahedron});
      }
    }
    i = end;
  }
  return edges;
}

MeshDefect find_edge_defect(std::vector<BoundaryEdge> edges) {
  const auto key = [](const BoundaryEdge& e) {
    return std::pair(std::min(e.from, e.to), std::max(e.from, e.to));
  };
  std::sort(edges.begin(), edges.end(),
            [&](const BoundaryEdge& a, const BoundaryEdge& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && key(edges[end]) == key(edges[i])) ++end;
    if (end - i != 2) {
      return {"the boundary is not a manifold: more than two of its triangles meet at an edge",
              {key(edges[i]).first, key(edges[i]).second},
              edges[i].tetrahedron};
    }
    i = end;
  }
  return {};
}

MeshDefect find_node_defect(std::vector<BoundaryEdge> edges) {
  // Around a clean boundary node the opposite edges of its triangles form one closed loop.
  std::sort(edges.begin(), edges.end(), [](const BoundaryEdge& a, const BoundaryEdge& b) {
    return std::pair(a.opposite, a.from) < std::pair(b.opposite, b.from);
  });
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].opposite == edges[begin].opposite) ++end;
    std::size_t visited = 0;
    int node = edges[begin].from;
    do {
      const auto next =
          std::lower_bound(edges.begin() + static_cast<std::ptrdiff_t>(begin),
                           edges.begin() + static_cast<std::ptrdiff_t>(end), node,
                           [](const BoundaryEdge& edge, int from) { return edge.from < from; });
      if (next == edges.begin() + static_cast<std::ptrdiff_t>(end) || next->from != node) break;
      node = next->to;
      ++visited;
    } while (node != edges[begin].from && visited <= end - begin);
    if (visited != end - begin) {
      return {"the boundary is not a manifold: two of its sheets touch at one node",
              {edges[begin].opposite},
              edges[begin].tetrahedron};
    }
    begin = end;
  }
  return {};
}

}  // namespace

Triangle sorted(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

std::vector<TetrahedronFace> faces_of(std::span<const Tetrahedron> tetrahedra) {
  std::vector<TetrahedronFace> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
    const auto& [a, b, c, d] = tetrahedra[i];
    for (const Triangle& face : {Triangle{a, c, b}, {a, b, d}, {b, c, d}, {a, d, c}}) {
      faces.push_back({sorted(face), face, static_cast<int>(i)});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const TetrahedronFace& a, const TetrahedronFace& b) {
    return std::pair(a.sorted, a.tetrahedron) < std::pair(b.sorted, b.tetrahedron);
  });
  return faces;
}

std::span<const TetrahedronFace> find_face(std::span<const TetrahedronFace> faces,
                                           const Triangle& triangle) {
  struct BySorted {
    bool operator()(const TetrahedronFace& face, const Triangle& t) const {
      return face.sorted < t;
    }
    bool operator()(const Triangle& t, const TetrahedronFace& face) const {
      return t < face.sorted;
    }
  };
  const auto [first, last] =
      std::equal_range(faces.begin(), faces.end(), sorted(triangle), BySorted());
  return {first, last};
}

MeshDefect find_boundary_defect(std::span<const TetrahedronFace> faces) {
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const TetrahedronFace& face = faces[i];
    if (faces[i + 1].sorted != face.sorted) continue;
    const std::vector<int> nodes(face.sorted.begin(), face.sorted.end());
    if (i + 2 < faces.size() && faces[i + 2].sorted == face.sorted) {
      return {"a face belongs to more than two tetrahedra", nodes, faces[i + 2].tetrahedron};
    }
    // Neighbours see their common face from opposite sides: one's order is the other's reversed.
    const Triangle& other = faces[i + 1].outward;
    for (std::size_t k = 0; k < 3; ++k) {
      if (other[k] == face.outward[0] && other[(k + 1) % 3] == face.outward[1]) {
        return {"two tetrahedra overlap on one side of their common face", nodes,
                faces[i + 1].tetrahedron};
      }
    }
  }
  const std::vector<BoundaryEdge> edges = boundary_edges(faces);
  MeshDefect defect = find_edge_defect(edges);
  return defect.message.empty() ? find_node_defect(edges) : defect;
}

}  // namespace softfinger
