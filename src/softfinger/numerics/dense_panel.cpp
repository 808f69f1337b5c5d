#include "softfinger/numerics/dense_panel.hpp"

namespace softfinger {

namespace baseline {
extern const DensePanelKernels kDensePanelKernels;
}
#if defined(__x86_64__)
namespace avx2 {
extern const DensePanelKernels kDensePanelKernels;
}
namespace avx512 {
extern const DensePanelKernels kDensePanelKernels;
}
#endif

const DensePanelKernels& dense_panel_kernels(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return avx512::kDensePanelKernels;
  if (set == InstructionSet::kAvx2) return avx2::kDensePanelKernels;
#endif
  (void)set;
  return baseline::kDensePanelKernels;
}

}  // namespace softfinger
