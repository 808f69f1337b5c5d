#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/spline_kernels.hpp"

namespace softfinger {

/// A function on a regular grid, stored in blocks of cells only where it is wanted, as coefficients
/// of tricubic B-splines: twice continuously differentiable across cells and blocks.
struct GridLevel {
  static constexpr int kCells = 8;         ///< of a block along an axis
  static constexpr int kRow = kCells + 3;  ///< coefficients along an axis: one before, two behind
  static constexpr int kBlockSize = kRow * kRow * kRow;

  double spacing = 0.0;             ///< m
  double per_spacing = 0.0;         ///< its inverse
  std::array<int, 3> blocks{};      ///< places of blocks along each axis
  std::vector<std::int32_t> index;  ///< per place, x fastest: number of its block, -1 for none
  std::vector<float> coefficients;  ///< kBlockSize per block, x fastest; m

  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const {
    return (z * static_cast<std::size_t>(blocks[1]) + y) * static_cast<std::size_t>(blocks[0]) + x;
  }
  [[nodiscard]] std::size_t places() const {
    return static_cast<std::size_t>(blocks[0]) * static_cast<std::size_t>(blocks[1]) *
           static_cast<std::size_t>(blocks[2]);
  }
};

/// Value and gradient at p (m) from the grid's lower corner, and the Hessian where wanted; false
/// where no block is stored.
template <bool kWithHessian>
[[nodiscard]] bool interpolate(const GridLevel& level, const SplineKernels& kernels,
                               const Vector3& p, SignedDistance& result);

}  // namespace softfinger
