#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx2
#define SOFTFINGER_KERNEL_DOUBLES 4
#include "softfinger/fem/element_kernels.inl"
