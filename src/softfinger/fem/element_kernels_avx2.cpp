#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx2
#include "softfinger/fem/element_kernels.inl"
