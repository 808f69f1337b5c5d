#include "softfinger/geometry/spline_kernels.hpp"

namespace softfinger {

namespace baseline {
extern const SplineKernels kSplineKernels;
}
#if defined(__x86_64__)
namespace avx2 {
extern const SplineKernels kSplineKernels;
}
#endif

const SplineKernels& spline_kernels(InstructionSet set) {
#if defined(__x86_64__)
  // Rows of four: wider registers would stay half empty.
  if (set != InstructionSet::kBaseline) return avx2::kSplineKernels;
#endif
  (void)set;
  return baseline::kSplineKernels;
}

}  // namespace softfinger
