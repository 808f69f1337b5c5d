#include "softfinger/fem/element_kernels.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE baseline
#include "softfinger/fem/element_kernels.inl"
