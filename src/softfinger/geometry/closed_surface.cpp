#include "softfinger/geometry/closed_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>

#include "softfinger/base/error.hpp"
#include "softfinger/base/stop_check.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// One side of a triangle; `low` < `high` are its vertices.
struct Side {
  int low;
  int high;
  int triangle;
  int k;
  bool forward;  ///< the triangle runs from low to high
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh, StopCheck& check) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k];
      const int to = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), static_cast<int>(t),
                       static_cast<int>(k), from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    check();
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

void link_neighbours(ClosedSurface& surface, const std::string& source, StopCheck& check) {
  const std::vector<Side> sides = sorted_sides(surface.mesh, check);
  std::size_t open = 0;
  std::size_t branching = 0;
  std::size_t turned = 0;
  std::array<Vector3, 3> at{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  surface.neighbours.resize(surface.mesh.triangles.size());
  for (std::size_t i = 0; i < sides.size();) {
    check();
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low &&
           sides[end].high == sides[i].high) {
      ++end;
    }
    const Vector3 middle = 0.5 * (surface.mesh.positions[static_cast<std::size_t>(sides[i].low)] +
                                  surface.mesh.positions[static_cast<std::size_t>(sides[i].high)]);
    const Side& a = sides[i];
    if (end - i == 1) {
      if (open++ == 0) at[0] = middle;
    } else if (end - i > 2) {
      if (branching++ == 0) at[1] = middle;
    } else if (const Side& b = sides[i + 1]; a.forward == b.forward) {
      if (turned++ == 0) at[2] = middle;
    } else {
      surface.neighbours[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.k)] =
          b.triangle;
      surface.neighbours[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.k)] =
          a.triangle;
    }
    i = end;
  }
  const auto fail = [&](const std::string& message) { throw InputError(source + ": " + message); };
  if (open > 0) {
    fail(fmt::format(
        "the surface is open: {} boundary edges, one at {}; only closed surfaces have an "
        "inside",
        open, place_in_mm(at[0])));
  }
  if (branching > 0) {
    fail(
        fmt::format("the surface branches: {} edges belong to more than two triangles, one at {}; "
                    "expected two at each edge",
                    branching, place_in_mm(at[1])));
  }
  if (turned > 0) {
    fail(
        fmt::format("neighbouring triangles face opposite ways at {} edges, one at {}; expected "
                    "all counter-clockwise seen from outside",
                    turned, place_in_mm(at[2])));
  }
}

void find_parts(ClosedSurface& surface, StopCheck& check) {
  surface.part.assign(surface.mesh.triangles.size(), -1);
  std::vector<int> waiting;
  for (std::size_t seed = 0; seed < surface.part.size(); ++seed) {
    if (surface.part[seed] >= 0) continue;
    const int part = static_cast<int>(surface.part_volume.size());
    // About a point of the part itself, so that nothing cancels far from the origin.
    const Vector3 origin = surface.corner(static_cast<int>(seed), 0);
    double volume = 0.0;
    surface.part[seed] = part;
    waiting.push_back(static_cast<int>(seed));
    while (!waiting.empty()) {
      check();
      const int t = waiting.back();
      waiting.pop_back();
      volume += (surface.corner(t, 0) - origin)
                    .cross(surface.corner(t, 1) - origin)
                    .dot(surface.corner(t, 2) - origin) /
                6.0;
      for (const int n : surface.neighbours[static_cast<std::size_t>(t)]) {
        if (surface.part[static_cast<std::size_t>(n)] >= 0) continue;
        surface.part[static_cast<std::size_t>(n)] = part;
        waiting.push_back(n);
      }
    }
    surface.part_volume.push_back(volume);
  }
}

}  // namespace

std::string place_in_mm(const Vector3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", p.x() / mm, p.y() / mm, p.z() / mm);
}

ClosedSurface closed_surface(TriangleMesh mesh, const std::string& source,
                             const std::stop_token& stop) {
  StopCheck check(stop);
  ClosedSurface surface;
  surface.mesh = std::move(mesh);
  if (surface.mesh.triangles.empty()) throw InputError(source + ": has no triangles");
  link_neighbours(surface, source, check);
  find_parts(surface, check);
  double volume = 0.0;
  for (const double part : surface.part_volume) volume += part;
  if (volume < 0.0) {
    throw InputError(
        fmt::format("{}: the surface is inside out: its volume is {:.6g} mm^3; expected "
                    "triangles counter-clockwise seen from outside",
                    source, volume / (mm * mm * mm)));
  }
  Eigen::AlignedBox3d bounds;
  for (const Vector3& p : surface.mesh.positions) bounds.extend(p);
  const double size = bounds.diagonal().norm();
  if (!(volume > 1e-12 * size * size * size)) {
    throw InputError(fmt::format("{}: the surface encloses no volume", source));
  }
  return surface;
}

}  // namespace softfinger
