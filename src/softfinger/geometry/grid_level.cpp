#include "softfinger/geometry/grid_level.hpp"

#include <algorithm>

namespace softfinger {

template <bool kWithHessian>
bool interpolate(const GridLevel& level, const SplineKernels& kernels, const Vector3& p,
                 SignedDistance& result) {
  constexpr int kRow = GridLevel::kRow;
  static_assert(kRow == kSplineRow);
  constexpr unsigned kCells = GridLevel::kCells;
  const double per_spacing = level.per_spacing;
  std::array<unsigned, 3> block;
  std::array<unsigned, 3> cell;
  std::array<double, 3> t;
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = p[static_cast<int>(k)] * per_spacing;
    const int last = level.blocks[k] * GridLevel::kCells - 1;
    const auto whole = static_cast<unsigned>(std::clamp(static_cast<int>(u), 0, last));
    t[k] = u - static_cast<int>(whole);
    block[k] = whole / kCells;
    cell[k] = whole % kCells;
  }
  const std::int32_t number = level.index[level.place(block[0], block[1], block[2])];
  if (number < 0) return false;
  const float* first = level.coefficients.data() +
                       static_cast<std::ptrdiff_t>(number) * GridLevel::kBlockSize +
                       static_cast<std::ptrdiff_t>((cell[2] * kRow + cell[1]) * kRow + cell[0]);
  std::array<double, 10> f;
  if constexpr (kWithHessian) {
    kernels.hessian(first, t.data(), f.data());
    result.hessian << f[4], f[5], f[6], f[5], f[7], f[8], f[6], f[8], f[9];
    result.hessian *= per_spacing * per_spacing;
  } else {
    kernels.gradient(first, t.data(), f.data());
  }
  result.distance = f[0];
  result.gradient = per_spacing * Vector3(f[1], f[2], f[3]);
  return true;
}

template bool interpolate<false>(const GridLevel&, const SplineKernels&, const Vector3&,
                                 SignedDistance&);
template bool interpolate<true>(const GridLevel&, const SplineKernels&, const Vector3&,
                                SignedDistance&);

}  // namespace softfinger
