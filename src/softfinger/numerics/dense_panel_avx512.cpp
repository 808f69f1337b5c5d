#include "softfinger/numerics/dense_panel.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx512
#include "softfinger/numerics/dense_panel.inl"
