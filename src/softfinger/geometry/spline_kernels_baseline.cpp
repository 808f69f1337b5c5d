#include "softfinger/geometry/spline_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE baseline
#include "softfinger/geometry/spline_kernels.inl"
