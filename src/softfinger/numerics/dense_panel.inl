// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

typedef float Vec __attribute__((vector_size(32)));
constexpr int kWide = 8;
static_assert(kPanelAlignment % kWide == 0);
constexpr int down(int row) { return row & ~(kWide - 1); }

// Panels are aligned, rows within them need not be. Not by a reference to a less aligned vector
// type: a template forgets that attribute.
struct InMemory {
  Vec value;
} __attribute__((packed, may_alias));
inline Vec at(const float* p) { return reinterpret_cast<const InMemory*>(p)->value; }
inline void put(float* p, const Vec& value) { reinterpret_cast<InMemory*>(p)->value = value; }

constexpr int place(unsigned vector, int stride) { return static_cast<int>(vector) * stride; }

// Columns come in threes: every block of the matrix is 3 wide.

/// Vectors of rows in a tile: with three columns they hide the latency of a multiplication and
/// leave room in the registers.
#if defined(__AVX__)
constexpr unsigned kTallest = 4;
#else
constexpr unsigned kTallest = 2;
#endif
enum class Result { kProduct, kDifference };

/// out (three columns from j, kVectors of rows from i) = A B^T, or less that, where A is the rows
/// and B the columns of `a`, each of `depth` columns.
template <Result kResult, unsigned kVectors>
inline void tile(const float* a, int a_stride, int i, int j, int depth, float* out,
                 int out_stride) {
  Vec s0[kVectors]{}, s1[kVectors]{}, s2[kVectors]{};
  for (int k = 0; k < depth; ++k) {
    const float* ak = a + k * a_stride;
    const float b0 = ak[j];
    const float b1 = ak[j + 1];
    const float b2 = ak[j + 2];
#pragma GCC unroll 4
    for (unsigned n = 0; n < kVectors; ++n) {
      const Vec v = at(ak + i + place(n, kWide));
      s0[n] += v * b0;
      s1[n] += v * b1;
      s2[n] += v * b2;
    }
  }
#pragma GCC unroll 4
  for (unsigned n = 0; n < kVectors; ++n) {
    float* o = out + j * out_stride + i + place(n, kWide);
    if constexpr (kResult == Result::kProduct) {
      put(o, s0[n]);
      put(o + out_stride, s1[n]);
      put(o + 2 * out_stride, s2[n]);
    } else {
      put(o, at(o) - s0[n]);
      put(o + out_stride, at(o + out_stride) - s1[n]);
      put(o + 2 * out_stride, at(o + 2 * out_stride) - s2[n]);
    }
  }
}

/// The tiles of three columns from j, from the diagonal down.
template <Result kResult>
inline void strip(const float* a, int a_stride, int rows, int j, int depth, float* out,
                  int out_stride) {
  int i = down(j);
  for (; i + place(kTallest - 1, kWide) < rows; i += place(kTallest, kWide)) {
    tile<kResult, kTallest>(a, a_stride, i, j, depth, out, out_stride);
  }
  for (; i + kWide < rows; i += 2 * kWide) {
    tile<kResult, 2>(a, a_stride, i, j, depth, out, out_stride);
  }
  for (; i < rows; i += kWide) tile<kResult, 1>(a, a_stride, i, j, depth, out, out_stride);
}

bool factor(float* panel, int rows, int columns, int stride) {
  for (int j = 0; j < columns; j += 3) {
    strip<Result::kDifference>(panel, stride, rows, j, j, panel, stride);
    float* c0 = panel + j * stride;
    float* c1 = c0 + stride;
    float* c2 = c1 + stride;
    const float pivot0 = c0[j];
    if (!(pivot0 > 0.0)) return false;
    const float i0 = 1.0F / __builtin_sqrtf(pivot0);
    const float l10 = c0[j + 1] * i0;
    const float l20 = c0[j + 2] * i0;
    const float pivot1 = c1[j + 1] - l10 * l10;
    if (!(pivot1 > 0.0)) return false;
    const float i1 = 1.0F / __builtin_sqrtf(pivot1);
    const float l21 = (c1[j + 2] - l20 * l10) * i1;
    const float pivot2 = c2[j + 2] - l20 * l20 - l21 * l21;
    if (!(pivot2 > 0.0)) return false;
    const float i2 = 1.0F / __builtin_sqrtf(pivot2);
    for (int i = down(j); i < rows; i += kWide) {
      const Vec v0 = at(c0 + i) * i0;
      const Vec v1 = (at(c1 + i) - v0 * l10) * i1;
      put(c2 + i, (at(c2 + i) - v0 * l20 - v1 * l21) * i2);
      put(c1 + i, v1);
      put(c0 + i, v0);
    }
    c0[j] = i0;
    c1[j + 1] = i1;
    c2[j + 2] = i2;
  }
  return true;
}

void outer_product(const float* a, int a_stride, int rows, int columns, int depth, float* out,
                   int out_stride) {
  for (int j = 0; j < columns; j += 3) {
    strip<Result::kProduct>(a, a_stride, rows, j, depth, out, out_stride);
  }
}

// Scratch vectors are padded like a panel column. Columns come in threes, which go together: a
// third of the reads and writes of t, and sums that do not wait for each other. Entries of L above
// its diagonal are not zero: the vector of rows that they share goes one by one.
template <unsigned kCount>
void forward(const float* panel, int rows, int columns, int stride, float* t, int t_stride) {
  for (int k = 0; k < columns; k += 3) {
    const float* c0 = panel + k * stride;
    const float* c1 = c0 + stride;
    const float* c2 = c1 + stride;
    float x0[kCount], x1[kCount], x2[kCount];
    for (unsigned n = 0; n < kCount; ++n) {
      float* tn = t + place(n, t_stride);
      tn[k] = x0[n] = tn[k] * c0[k];
      tn[k + 1] = x1[n] = (tn[k + 1] - c0[k + 1] * x0[n]) * c1[k + 1];
      tn[k + 2] = x2[n] = (tn[k + 2] - c0[k + 2] * x0[n] - c1[k + 2] * x1[n]) * c2[k + 2];
    }
    int i = k + 3;
    for (; i < rows && i != down(i); ++i) {
      for (unsigned n = 0; n < kCount; ++n) {
        float& tn = t[place(n, t_stride) + i];
        tn = tn - c0[i] * x0[n] - c1[i] * x1[n] - c2[i] * x2[n];
      }
    }
    for (; i < rows; i += kWide) {
      const Vec v0 = at(c0 + i);
      const Vec v1 = at(c1 + i);
      const Vec v2 = at(c2 + i);
      for (unsigned n = 0; n < kCount; ++n) {
        float* tn = t + place(n, t_stride) + i;
        put(tn, at(tn) - v0 * x0[n] - v1 * x1[n] - v2 * x2[n]);
      }
    }
  }
}

inline float sum_of(const Vec& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

template <unsigned kCount>
void backward(const float* panel, int rows, int columns, int stride, float* t, int t_stride) {
  for (int k = columns - 3; k >= 0; k -= 3) {
    const float* c0 = panel + k * stride;
    const float* c1 = c0 + stride;
    const float* c2 = c1 + stride;
    float s0[kCount]{}, s1[kCount]{}, s2[kCount]{};
    Vec v0[kCount]{}, v1[kCount]{}, v2[kCount]{};
    const auto add = [&](int i) {
      for (unsigned n = 0; n < kCount; ++n) {
        const float tn = t[place(n, t_stride) + i];
        s0[n] += c0[i] * tn;
        s1[n] += c1[i] * tn;
        s2[n] += c2[i] * tn;
      }
    };
    int i = k + 3;
    for (; i < rows && i != down(i); ++i) add(i);
    for (; i + kWide <= rows; i += kWide) {
      const Vec l0 = at(c0 + i);
      const Vec l1 = at(c1 + i);
      const Vec l2 = at(c2 + i);
      for (unsigned n = 0; n < kCount; ++n) {
        const Vec tn = at(t + place(n, t_stride) + i);
        v0[n] += l0 * tn;
        v1[n] += l1 * tn;
        v2[n] += l2 * tn;
      }
    }
    for (; i < rows; ++i) add(i);
    for (unsigned n = 0; n < kCount; ++n) {
      float* tn = t + place(n, t_stride);
      tn[k + 2] = (tn[k + 2] - (s2[n] + sum_of(v2[n]))) * c2[k + 2];
      tn[k + 1] = (tn[k + 1] - (s1[n] + sum_of(v1[n])) - c1[k + 2] * tn[k + 2]) * c1[k + 1];
      tn[k] =
          (tn[k] - (s0[n] + sum_of(v0[n])) - c0[k + 2] * tn[k + 2] - c0[k + 1] * tn[k + 1]) * c0[k];
    }
  }
}

}  // namespace

extern const DensePanelKernels kDensePanelKernels;
const DensePanelKernels kDensePanelKernels{
    &factor, &outer_product, &forward<1>, &forward<kTogether>, &backward<1>, &backward<kTogether>};

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
