#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "softfinger/geometry/grid_level.hpp"
#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

/// Signed distance to a closed triangle mesh, sampled once and interpolated: regular grids of
/// spacing h, 2 h, 4 h, ..., each stored only within a band of a few of its spacings about the
/// surface, the last one everywhere in `domain`. Tricubic B-splines within a grid and a smooth
/// blend from one to the next make the distance twice continuously differentiable in the domain.
/// Outside it is sqrt(f^2 + b^2) of the value f at the nearest point of the domain, b away: never
/// more than the true distance (of the surface as interpolated), continuous, its gradient not.
///
/// Immutable; queries allocate nothing and may run at the same time.
class SignedDistanceGrid {
 public:
  static constexpr double kBandStart = 1.5;  ///< spacings from the surface where a blend starts
  static constexpr double kBandEnd = 3.0;    ///< and where the next grid has taken over

  struct Content {
    Eigen::AlignedBox3d domain;     ///< m; blocks start at its lower corner and cover it
    Eigen::AlignedBox3d bounds;     ///< of the mesh, m
    std::vector<GridLevel> levels;  ///< finest first; the last has every block
    std::uint64_t triangle_count = 0;
    TriangleMesh drawing;  ///< the surface, simplified to be drawn
  };
  /// `source`: the mesh file; `source_hash`: of its content.
  SignedDistanceGrid(Content content, std::filesystem::path source, std::uint64_t source_hash);

  /// At p_O (m). The gradient is the interpolant's own: of unit length up to the interpolation's
  /// error, shorter where an edge is rounded or nothing is nearest.
  [[nodiscard]] SignedDistance signed_distance(const Vector3& p_O) const;
  /// The same without the Hessian, which stays zero.
  [[nodiscard]] SignedDistance distance_and_gradient(const Vector3& p_O) const;

  [[nodiscard]] const Content& content() const { return content_; }
  [[nodiscard]] const std::filesystem::path& source() const { return source_; }
  [[nodiscard]] std::uint64_t source_hash() const { return source_hash_; }
  /// Bytes of samples.
  [[nodiscard]] std::size_t memory() const;

 private:
  template <bool kWithHessian>
  [[nodiscard]] SignedDistance evaluate(const Vector3& p_O) const;
  template <bool kWithHessian>
  void from_level(std::size_t l, const Vector3& p_O, SignedDistance& finer) const;
  Content content_;
  std::filesystem::path source_;
  std::uint64_t source_hash_;
  const SplineKernels& kernels_;
};

}  // namespace softfinger
