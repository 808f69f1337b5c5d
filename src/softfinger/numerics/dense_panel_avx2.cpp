#include "softfinger/numerics/dense_panel.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE avx2
#include "softfinger/numerics/dense_panel.inl"
