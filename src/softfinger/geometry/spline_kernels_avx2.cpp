#include "softfinger/geometry/spline_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx2
#include "softfinger/geometry/spline_kernels.inl"
