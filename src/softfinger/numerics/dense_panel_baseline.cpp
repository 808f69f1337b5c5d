#include "softfinger/numerics/dense_panel.hpp"

#define SOFTFINGER_KERNEL_NAMESPACE baseline
#include "softfinger/numerics/dense_panel.inl"
