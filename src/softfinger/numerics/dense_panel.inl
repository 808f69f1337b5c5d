// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

// Unaligned-load vector: panels are 32-byte aligned, rows within them need not be.
typedef double Vec __attribute__((vector_size(32), aligned(8), may_alias));

inline Vec& at(double* p) { return *reinterpret_cast<Vec*>(p); }
inline const Vec& at(const double* p) { return *reinterpret_cast<const Vec*>(p); }

bool factor(double* panel, int rows, int columns, int stride) {
  for (int j = 0; j < columns; ++j) {
    double* cj = panel + j * stride;
    const double pivot = cj[j];
    if (!(pivot > 0.0)) return false;
    const double inverse = 1.0 / __builtin_sqrt(pivot);
    const int first = j & ~3;
    for (int i = first; i < rows; i += 4) at(cj + i) = at(cj + i) * inverse;
    int k = j + 1;
    for (; k + 1 < columns; k += 2) {
      double* c0 = panel + k * stride;
      double* c1 = c0 + stride;
      const double f0 = cj[k];
      const double f1 = cj[k + 1];
      for (int i = k & ~3; i < rows; i += 4) {
        const Vec v = at(cj + i);
        at(c0 + i) = at(c0 + i) - v * f0;
        at(c1 + i) = at(c1 + i) - v * f1;
      }
    }
    for (; k < columns; ++k) {
      double* ck = panel + k * stride;
      const double f = cj[k];
      for (int i = k & ~3; i < rows; i += 4) at(ck + i) = at(ck + i) - at(cj + i) * f;
    }
  }
  return true;
}

void outer_product(const double* a, int a_stride, int rows, int columns, int depth, double* out,
                   int out_stride) {
  // Columns come in threes: every block of the matrix is 3 wide.
  for (int j = 0; j < columns; j += 3) {
    int i = j & ~3;
    for (; i + 4 < rows; i += 8) {
      Vec s00{}, s01{}, s02{}, s10{}, s11{}, s12{};
      for (int k = 0; k < depth; ++k) {
        const double* ak = a + k * a_stride;
        const Vec v0 = at(ak + i);
        const Vec v1 = at(ak + i + 4);
        const double b0 = ak[j];
        const double b1 = ak[j + 1];
        const double b2 = ak[j + 2];
        s00 += v0 * b0;
        s01 += v0 * b1;
        s02 += v0 * b2;
        s10 += v1 * b0;
        s11 += v1 * b1;
        s12 += v1 * b2;
      }
      double* o = out + j * out_stride + i;
      at(o) = s00;
      at(o + 4) = s10;
      at(o + out_stride) = s01;
      at(o + out_stride + 4) = s11;
      at(o + 2 * out_stride) = s02;
      at(o + 2 * out_stride + 4) = s12;
    }
    for (; i < rows; i += 4) {
      Vec s0{}, s1{}, s2{};
      for (int k = 0; k < depth; ++k) {
        const double* ak = a + k * a_stride;
        const Vec v = at(ak + i);
        s0 += v * ak[j];
        s1 += v * ak[j + 1];
        s2 += v * ak[j + 2];
      }
      double* o = out + j * out_stride + i;
      at(o) = s0;
      at(o + out_stride) = s1;
      at(o + 2 * out_stride) = s2;
    }
  }
}

// The scratch vector t is padded like a panel column.
void solve_forward(const double* panel, int rows, int columns, int stride, double* t) {
  for (int k = 0; k < columns; ++k) {
    const double* ck = panel + k * stride;
    const double x = t[k] / ck[k];
    t[k] = x;
    int i = k + 1;
    for (; i < rows && (i & 3) != 0; ++i) t[i] -= ck[i] * x;
    for (; i < rows; i += 4) at(t + i) = at(t + i) - at(ck + i) * x;
  }
}

void solve_backward(const double* panel, int rows, int columns, int stride, double* t) {
  for (int k = columns - 1; k >= 0; --k) {
    const double* ck = panel + k * stride;
    double sum = 0.0;
    int i = k + 1;
    for (; i < rows && (i & 3) != 0; ++i) sum += ck[i] * t[i];
    Vec lanes{};
    for (; i + 4 <= rows; i += 4) lanes += at(ck + i) * at(t + i);
    for (; i < rows; ++i) sum += ck[i] * t[i];
    sum += (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    t[k] = (t[k] - sum) / ck[k];
  }
}

}  // namespace

extern const DensePanelKernels kDensePanelKernels;
const DensePanelKernels kDensePanelKernels{&factor, &outer_product, &solve_forward,
                                           &solve_backward};

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
