#include "softfinger/geometry/surface_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Neighbours whose normals add to less than this lie on each other.
constexpr double kFolded = 1e-6;
/// Of the cube of a triangle's size: smaller volumes are rounding, and count as touching.
constexpr double kTouching = 1e-11;

using Corners = std::array<Vector3, 3>;

double volume(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the segment p q passes from one side of the triangle to the other; through its border
/// counts, as where a mesh meets its mirror image.
bool passes_through(const Corners& t, const Vector3& p, const Vector3& q, double rounding) {
  const double before = volume(t[0], t[1], t[2], p);
  const double after = volume(t[0], t[1], t[2], q);
  if (std::abs(before) <= rounding || std::abs(after) <= rounding) return false;
  if ((before > 0.0) == (after > 0.0)) return false;
  const double u = volume(p, q, t[0], t[1]);
  const double v = volume(p, q, t[1], t[2]);
  const double w = volume(p, q, t[2], t[0]);
  return (u >= -rounding && v >= -rounding && w >= -rounding) ||
         (u <= rounding && v <= rounding && w <= rounding);
}

/// Middle of a side of one that passes through the other.
std::optional<Vector3> crossing(const Corners& a, const Corners& b) {
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    size = std::max({size, (a[k] - a[(k + 1) % 3]).norm(), (b[k] - b[(k + 1) % 3]).norm()});
  }
  const double rounding = kTouching * size * size * size;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (passes_through(b, a[k], a[next], rounding)) return 0.5 * (a[k] + a[next]);
    if (passes_through(a, b[k], b[next], rounding)) return 0.5 * (b[k] + b[next]);
  }
  return {};
}

void refuse_crossings(const ClosedSurface& surface, const TriangleTree& tree,
                      const std::string& source, const Progress& progress) {
  constexpr std::size_t kChunk = 1024;
  const std::size_t count = surface.mesh.triangles.size();
  std::mutex mutex;
  std::size_t crossings = 0;
  int first = static_cast<int>(count);
  Vector3 at = Vector3::Zero();
  const auto look_at = [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
      const int t = static_cast<int>(i);
      const Corners own{surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2)};
      Eigen::AlignedBox3d box(own[0]);
      box.extend(own[1]).extend(own[2]);
      tree.overlapping(box, [&](int other) {
        if (other <= t) return false;
        const auto found = crossing(
            own, {surface.corner(other, 0), surface.corner(other, 1), surface.corner(other, 2)});
        if (!found) return false;
        const std::lock_guard lock(mutex);
        ++crossings;
        if (t < first) {
          first = t;
          at = *found;
        }
        return true;
      });
    }
  };
  parallel_for((count + kChunk - 1) / kChunk, look_at, progress);
  if (crossings == 0) return;
  throw InputError(
      fmt::format("{}: the surface passes through itself: {} triangles cross another, "
                  "one near {}; expected none",
                  source, crossings, place_in_mm(at)));
}

/// Where two neighbours lie on each other nobody can say on which side of both a point is.
void refuse_folds(const ClosedSurface& surface, const std::string& source,
                  const Progress& progress) {
  constexpr std::size_t kToldEvery = 4096;
  const auto normal = [&](int t) {
    const Vector3 edge = surface.corner(t, 1) - surface.corner(t, 0);
    return Vector3(edge.cross(surface.corner(t, 2) - surface.corner(t, 0)).normalized());
  };
  for (std::size_t i = 0; i < surface.neighbours.size(); ++i) {
    if (progress && i % kToldEvery == 0) progress(0.0);
    const int t = static_cast<int>(i);
    const Vector3 own = normal(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const int neighbour = surface.neighbours[i][k];
      if (neighbour < t || own.isZero(0.0)) continue;
      const Vector3 other = normal(neighbour);
      if (other.isZero(0.0) || (own + other).norm() > kFolded) continue;
      throw InputError(
          fmt::format("{}: the surface is folded flat onto itself near {}; expected a solid",
                      source, place_in_mm(surface.corner(t, static_cast<int>(k)))));
    }
  }
}

void refuse_nested_parts(const ClosedSurface& surface, const TriangleTree& tree,
                         const std::string& source) {
  if (surface.part_volume.size() < 2) return;
  std::vector<bool> looked_at(surface.part_volume.size());
  for (std::size_t t = 0; t < surface.part.size(); ++t) {
    const auto part = static_cast<std::size_t>(surface.part[t]);
    if (looked_at[part]) continue;
    looked_at[part] = true;
    const Vector3 corner = surface.corner(static_cast<int>(t), 0);
    const int winding = tree.winding_without(surface.part[t], corner);
    if (surface.part_volume[part] < 0.0 && winding != 1) {
      throw InputError(
          fmt::format("{}: a separate part of the surface near {} is inside out; only "
                      "a cavity inside the solid may be",
                      source, place_in_mm(corner)));
    }
    if (surface.part_volume[part] >= 0.0 && winding != 0) {
      throw InputError(
          fmt::format("{}: a separate part of the surface near {} lies inside another; "
                      "expected it outside, or turned inside out as a cavity",
                      source, place_in_mm(corner)));
    }
  }
}

}  // namespace

void check_surface(const ClosedSurface& surface, const TriangleTree& tree,
                   const std::string& source, const Progress& progress) {
  refuse_folds(surface, source, progress);
  refuse_crossings(surface, tree, source, progress);
  refuse_nested_parts(surface, tree, source);
}

}  // namespace softfinger
