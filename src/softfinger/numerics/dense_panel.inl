// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

// Unaligned-load vector: panels are aligned, rows within them need not be.
typedef float Vec __attribute__((vector_size(32), aligned(4), may_alias));
constexpr int kWide = 8;
static_assert(kPanelAlignment % kWide == 0);
constexpr int down(int row) { return row & ~(kWide - 1); }

inline Vec& at(float* p) { return *reinterpret_cast<Vec*>(p); }
inline const Vec& at(const float* p) { return *reinterpret_cast<const Vec*>(p); }

bool factor(float* panel, int rows, int columns, int stride) {
  for (int j = 0; j < columns; ++j) {
    float* cj = panel + j * stride;
    const float pivot = cj[j];
    if (!(pivot > 0.0)) return false;
    const float inverse = 1.0F / __builtin_sqrtf(pivot);
    for (int i = down(j); i < rows; i += kWide) at(cj + i) = at(cj + i) * inverse;
    cj[j] = inverse;
    int k = j + 1;
    for (; k + 1 < columns; k += 2) {
      float* c0 = panel + k * stride;
      float* c1 = c0 + stride;
      const float f0 = cj[k];
      const float f1 = cj[k + 1];
      for (int i = down(k); i < rows; i += kWide) {
        const Vec v = at(cj + i);
        at(c0 + i) = at(c0 + i) - v * f0;
        at(c1 + i) = at(c1 + i) - v * f1;
      }
    }
    for (; k < columns; ++k) {
      float* ck = panel + k * stride;
      const float f = cj[k];
      for (int i = down(k); i < rows; i += kWide) at(ck + i) = at(ck + i) - at(cj + i) * f;
    }
  }
  return true;
}

void outer_product(const float* a, int a_stride, int rows, int columns, int depth, float* out,
                   int out_stride) {
  // Columns come in threes: every block of the matrix is 3 wide.
  for (int j = 0; j < columns; j += 3) {
    int i = down(j);
    for (; i + kWide < rows; i += 2 * kWide) {
      Vec s00{}, s01{}, s02{}, s10{}, s11{}, s12{};
      for (int k = 0; k < depth; ++k) {
        const float* ak = a + k * a_stride;
        const Vec v0 = at(ak + i);
        const Vec v1 = at(ak + i + kWide);
        const float b0 = ak[j];
        const float b1 = ak[j + 1];
        const float b2 = ak[j + 2];
        s00 += v0 * b0;
        s01 += v0 * b1;
        s02 += v0 * b2;
        s10 += v1 * b0;
        s11 += v1 * b1;
        s12 += v1 * b2;
      }
      float* o = out + j * out_stride + i;
      at(o) = s00;
      at(o + kWide) = s10;
      at(o + out_stride) = s01;
      at(o + out_stride + kWide) = s11;
      at(o + 2 * out_stride) = s02;
      at(o + 2 * out_stride + kWide) = s12;
    }
    for (; i < rows; i += kWide) {
      Vec s0{}, s1{}, s2{};
      for (int k = 0; k < depth; ++k) {
        const float* ak = a + k * a_stride;
        const Vec v = at(ak + i);
        s0 += v * ak[j];
        s1 += v * ak[j + 1];
        s2 += v * ak[j + 2];
      }
      float* o = out + j * out_stride + i;
      at(o) = s0;
      at(o + out_stride) = s1;
      at(o + 2 * out_stride) = s2;
    }
  }
}

// The scratch vector t is padded like a panel column.
void solve_forward(const float* panel, int rows, int columns, int stride, float* t) {
  for (int k = 0; k < columns; ++k) {
    const float* ck = panel + k * stride;
    const float x = t[k] * ck[k];
    t[k] = x;
    // Entries of L above its diagonal are not zero: the vector they share goes one by one.
    int i = k + 1;
    for (; i < rows && i != down(i); ++i) t[i] -= ck[i] * x;
    for (; i < rows; i += kWide) at(t + i) = at(t + i) - at(ck + i) * x;
  }
}

void solve_backward(const float* panel, int rows, int columns, int stride, float* t) {
  for (int k = columns - 1; k >= 0; --k) {
    const float* ck = panel + k * stride;
    float sum = 0.0F;
    int i = k + 1;
    for (; i < rows && i != down(i); ++i) sum += ck[i] * t[i];
    Vec lanes{};
    for (; i + kWide <= rows; i += kWide) lanes += at(ck + i) * at(t + i);
    for (; i < rows; ++i) sum += ck[i] * t[i];
    sum += ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) +
           ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
    t[k] = (t[k] - sum) * ck[k];
  }
}

}  // namespace

extern const DensePanelKernels kDensePanelKernels;
const DensePanelKernels kDensePanelKernels{&factor, &outer_product, &solve_forward,
                                           &solve_backward};

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
