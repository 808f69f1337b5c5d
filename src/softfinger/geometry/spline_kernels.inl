// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

typedef float Floats __attribute__((vector_size(16), aligned(4), may_alias));
typedef double Row __attribute__((vector_size(32)));

inline Row load(const float* p) {
#if defined(__AVX2__)
  return _mm256_cvtps_pd(_mm_loadu_ps(p));  // left alone, the compiler takes three steps
#else
  return __builtin_convertvector(*reinterpret_cast<const Floats*>(p), Row);
#endif
}

inline double dot(Row a, Row b) {
  const Row p = a * b;
  return (p[0] + p[1]) + (p[2] + p[3]);
}

/// Uniform cubic B-splines on a cell's four coefficients, and their derivatives.
inline Row value(double t) {
  constexpr Row k0{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0};
  constexpr Row k1{-0.5, 0.0, 0.5, 0.0};
  constexpr Row k2{0.5, -1.0, 0.5, 0.0};
  constexpr Row k3{-1.0 / 6.0, 0.5, -0.5, 1.0 / 6.0};
  return k0 + t * (k1 + t * (k2 + t * k3));
}
inline Row slope(double t) {
  constexpr Row k0{-0.5, 0.0, 0.5, 0.0};
  constexpr Row k1{1.0, -2.0, 1.0, 0.0};
  constexpr Row k2{-0.5, 1.5, -1.5, 0.5};
  return k0 + t * (k1 + t * k2);
}
inline Row bend(double t) {
  constexpr Row k0{1.0, -2.0, 1.0, 0.0};
  constexpr Row k1{-1.0, 3.0, -3.0, 1.0};
  return k0 + t * k1;
}

template <bool kWithHessian>
inline void evaluate(const float* first, const double* t, double* out) {
  const Row y = value(t[1]);
  const Row dy = slope(t[1]);
  const Row ddy = bend(t[1]);
  const Row z = value(t[2]);
  const Row dz = slope(t[2]);
  const Row ddz = bend(t[2]);
  // Summed over y and z; what is left are four numbers along x.
  Row sum{}, by_y{}, by_z{}, by_yy{}, by_yz{}, by_zz{};
  for (int k = 0; k < 4; ++k) {
    Row plane{}, plane_by_y{}, plane_by_yy{};
    for (int j = 0; j < 4; ++j) {
      const Row row = load(first + (k * kSplineRow + j) * kSplineRow);
      plane += y[j] * row;
      plane_by_y += dy[j] * row;
      if constexpr (kWithHessian) plane_by_yy += ddy[j] * row;
    }
    sum += z[k] * plane;
    by_y += z[k] * plane_by_y;
    by_z += dz[k] * plane;
    if constexpr (kWithHessian) {
      by_yy += z[k] * plane_by_yy;
      by_yz += dz[k] * plane_by_y;
      by_zz += ddz[k] * plane;
    }
  }
  const Row x = value(t[0]);
  const Row dx = slope(t[0]);
  out[0] = dot(x, sum);
  out[1] = dot(dx, sum);
  out[2] = dot(x, by_y);
  out[3] = dot(x, by_z);
  if constexpr (kWithHessian) {
    out[4] = dot(bend(t[0]), sum);
    out[5] = dot(dx, by_y);
    out[6] = dot(dx, by_z);
    out[7] = dot(x, by_yy);
    out[8] = dot(x, by_yz);
    out[9] = dot(x, by_zz);
  }
}

void gradient(const float* first, const double* t, double* out) { evaluate<false>(first, t, out); }
void hessian(const float* first, const double* t, double* out) { evaluate<true>(first, t, out); }

}  // namespace

extern const SplineKernels kSplineKernels;
const SplineKernels kSplineKernels{gradient, hessian};

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
