#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx512
#define SOFTFINGER_KERNEL_DOUBLES 8
#include "softfinger/fem/element_kernels.inl"
