#include "softfinger/fem/element_kernels.hpp"

namespace softfinger {

namespace baseline {
extern const ElementKernels kElementKernels;
}
#if defined(__x86_64__)
namespace avx2 {
extern const ElementKernels kElementKernels;
}
namespace avx512 {
extern const ElementKernels kElementKernels;
}
#endif

const ElementKernels& element_kernels(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return avx512::kElementKernels;
  if (set == InstructionSet::kAvx2) return avx2::kElementKernels;
#endif
  (void)set;
  return baseline::kElementKernels;
}

}  // namespace softfinger
