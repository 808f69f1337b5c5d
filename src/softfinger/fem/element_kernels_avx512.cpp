#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx512
#include "softfinger/fem/element_kernels.inl"
