// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#if !defined(SOFTFINGER_KERNEL_NAMESPACE) || !defined(SOFTFINGER_KERNEL_DOUBLES)
#error "define SOFTFINGER_KERNEL_NAMESPACE and SOFTFINGER_KERNEL_DOUBLES, the doubles in a vector"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

// Gradients in double precision, kWide elements at a time; second derivatives, which only steer the
// iteration, in single precision for the whole group. Comparisons give all-ones or all-zeros lanes.
constexpr int kWide = SOFTFINGER_KERNEL_DOUBLES;
static_assert(kLanes == 8 && kLanes % kWide == 0);
typedef double Doubles __attribute__((vector_size(8 * kWide)));
typedef long long Mask __attribute__((vector_size(8 * kWide)));
typedef double GroupDoubles __attribute__((vector_size(8 * kLanes)));
typedef float Floats __attribute__((vector_size(4 * kLanes)));

template <typename Vector>
using InMemory [[gnu::may_alias]] = Vector;
inline Doubles load(const double* p) { return *reinterpret_cast<const InMemory<Doubles>*>(p); }
inline void store(double* p, Doubles v) { *reinterpret_cast<InMemory<Doubles>*>(p) = v; }
inline Floats load(const float* p) { return *reinterpret_cast<const InMemory<Floats>*>(p); }
inline void store(float* p, Floats v) { *reinterpret_cast<InMemory<Floats>*>(p) = v; }
inline Floats load_as_floats(const double* p) {
  return __builtin_convertvector(*reinterpret_cast<const InMemory<GroupDoubles>*>(p), Floats);
}
inline Doubles splat(double v) { return Doubles{} + v; }
inline Doubles select(Mask m, Doubles a, Doubles b) { return m ? a : b; }
inline Doubles max(Doubles a, Doubles b) { return a > b ? a : b; }
inline Doubles min(Doubles a, Doubles b) { return a < b ? a : b; }
inline Doubles abs(Doubles a) { return a < 0.0 ? -a : a; }
inline Doubles sqrt(Doubles a) {
  Doubles r;
  for (int i = 0; i < kWide; ++i) r[i] = __builtin_sqrt(a[i]);
  return r;
}
inline bool any(Mask m) {
  long long some = 0;
  for (int i = 0; i < kWide; ++i) some |= m[i];
  return some != 0;
}

template <typename Lanes>
struct Vec {
  Lanes x, y, z;
};
using Vec3 = Vec<Doubles>;
template <typename L>
inline Vec<L> operator+(Vec<L> a, Vec<L> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename L>
inline Vec<L> operator-(Vec<L> a, Vec<L> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename L>
inline Vec<L> operator*(Vec<L> a, L f) {
  return {a.x * f, a.y * f, a.z * f};
}
template <typename L>
inline L dot(Vec<L> a, Vec<L> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename L>
inline Vec<L> cross(Vec<L> a, Vec<L> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3 select(Mask m, Vec3 a, Vec3 b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// 3 x 3 matrix by columns.
template <typename Lanes>
struct Mat {
  Vec<Lanes> c[3];
};
using Mat3 = Mat<Doubles>;
template <typename L>
inline Vec<L> operator*(const Mat<L>& m, Vec<L> v) {
  return m.c[0] * v.x + m.c[1] * v.y + m.c[2] * v.z;
}
template <typename L>
inline Mat<L> operator*(const Mat<L>& a, const Mat<L>& b) {
  return {{a * b.c[0], a * b.c[1], a * b.c[2]}};
}
template <typename L>
inline Mat<L> operator*(const Mat<L>& m, L f) {
  return {{m.c[0] * f, m.c[1] * f, m.c[2] * f}};
}
template <typename L>
inline Mat<L> operator+(const Mat<L>& a, const Mat<L>& b) {
  return {{a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}};
}
template <typename L>
inline Mat<L> transpose(const Mat<L>& m) {
  return {{{m.c[0].x, m.c[1].x, m.c[2].x},
           {m.c[0].y, m.c[1].y, m.c[2].y},
           {m.c[0].z, m.c[1].z, m.c[2].z}}};
}
template <typename L>
inline Vec<L> transpose_times(const Mat<L>& m, Vec<L> v) {
  return {dot(m.c[0], v), dot(m.c[1], v), dot(m.c[2], v)};
}

template <typename Lanes, typename Number>
inline Mat<Lanes> load_matrix(const Number p[9][kLanes], int first) {
  Mat<Lanes> m;
  for (int c = 0; c < 3; ++c) {
    m.c[c] = {load(p[3 * c] + first), load(p[3 * c + 1] + first), load(p[3 * c + 2] + first)};
  }
  return m;
}
template <typename Lanes, typename Number>
inline void store_matrix(Number p[9][kLanes], int first, const Mat<Lanes>& m) {
  for (int c = 0; c < 3; ++c) {
    store(p[3 * c] + first, m.c[c].x);
    store(p[3 * c + 1] + first, m.c[c].y);
    store(p[3 * c + 2] + first, m.c[c].z);
  }
}

/// A vector of each element's node a, stored x y z node by node.
template <typename Lanes>
inline Vec<Lanes> gather(const ElementGroup& group, int a, int first, const double* vectors) {
  Vec<Lanes> v;
  using Number = std::remove_cvref_t<decltype(v.x[0])>;
  constexpr int kCount = sizeof(Lanes) / sizeof(Number);
  for (int lane = 0; lane < kCount; ++lane) {
    const double* p = vectors + 3 * group.nodes[a][first + lane];
    v.x[lane] = static_cast<Number>(p[0]);
    v.y[lane] = static_cast<Number>(p[1]);
    v.z[lane] = static_cast<Number>(p[2]);
  }
  return v;
}

/// One Jacobi rotation that zeroes h, the inner product of columns p and q of B = F V; applied to
/// both B and V. One-sided (Hestenes 1958), so small stretches keep their accuracy.
inline void rotate(Vec3& bp, Vec3& bq, Vec3& vp, Vec3& vq, Doubles h) {
  const Doubles d = dot(bq, bq) - dot(bp, bp);
  const Doubles h2 = h + h;
  const Doubles denominator = abs(d) + sqrt(d * d + h2 * h2) + 1e-300;
  const Doubles t = select(d < 0.0, -h2, h2) / denominator;
  const Doubles c = 1.0 / sqrt(1.0 + t * t);
  const Doubles s = t * c;
  const Vec3 b = bp * c - bq * s;
  bq = bp * s + bq * c;
  bp = b;
  const Vec3 v = vp * c - vq * s;
  vq = vp * s + vq * c;
  vp = v;
}

inline void sort_pair(Vec3& bp, Vec3& bq, Vec3& vp, Vec3& vq) {
  const Mask swap = dot(bp, bp) < dot(bq, bq);
  // Negating one of the two keeps det V = 1.
  const Vec3 b = select(swap, bq, bp);
  bq = select(swap, bp * splat(-1.0), bq);
  bp = b;
  const Vec3 v = select(swap, vq, vp);
  vq = select(swap, vp * splat(-1.0), vq);
  vp = v;
}

inline Vec3 any_perpendicular(Vec3 a) {
  const Mask along_x = abs(a.x) > 0.7;
  const Doubles zero{};
  const Vec3 axis{select(along_x, zero, splat(1.0)), select(along_x, splat(1.0), zero), zero};
  const Vec3 p = cross(a, axis);
  return p * (1.0 / sqrt(dot(p, p)));
}

struct Svd {
  Mat3 u, v;
  Doubles s[3];
};

/// Rotation-variant singular value decomposition; `v` is a start, any rotation will do.
inline Svd decompose(const Mat3& f, Mat3 v) {
  // A warm start drifts from a rotation by rounding: one Newton-Schulz step renews it.
  Mat3 renewed;
  for (int c = 0; c < 3; ++c) {
    const Vec3 w = transpose_times(v, v.c[c]);
    renewed.c[c] = v.c[c] * splat(1.5) - (v * w) * splat(0.5);
  }
  v = renewed;
  Mat3 b = f * v;
  constexpr int kMaxSweeps = 12;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const Doubles h01 = dot(b.c[0], b.c[1]);
    const Doubles h02 = dot(b.c[0], b.c[2]);
    const Doubles h12 = dot(b.c[1], b.c[2]);
    const Doubles off = abs(h01) + abs(h02) + abs(h12);
    const Doubles scale = dot(b.c[0], b.c[0]) + dot(b.c[1], b.c[1]) + dot(b.c[2], b.c[2]);
    if (!any(off > 1e-13 * scale)) break;
    rotate(b.c[0], b.c[1], v.c[0], v.c[1], h01);
    rotate(b.c[0], b.c[2], v.c[0], v.c[2], dot(b.c[0], b.c[2]));
    rotate(b.c[1], b.c[2], v.c[1], v.c[2], dot(b.c[1], b.c[2]));
  }
  sort_pair(b.c[0], b.c[1], v.c[0], v.c[1]);
  sort_pair(b.c[0], b.c[2], v.c[0], v.c[2]);
  sort_pair(b.c[1], b.c[2], v.c[1], v.c[2]);
  Svd result;
  result.v = v;
  const Doubles n0 = sqrt(dot(b.c[0], b.c[0]));
  const Mask collapsed = n0 < 1e-12;
  const Doubles zero{};
  const Vec3 x_axis{splat(1.0), zero, zero};
  const Vec3 u0 = select(collapsed, x_axis, b.c[0] * (1.0 / max(n0, splat(1e-12))));
  const Vec3 p1 = b.c[1] - u0 * dot(u0, b.c[1]);
  const Doubles n1 = sqrt(dot(p1, p1));
  const Vec3 u1 = select(n1 < 1e-12, any_perpendicular(u0), p1 * (1.0 / max(n1, splat(1e-12))));
  const Vec3 u2 = cross(u0, u1);
  result.u = {{u0, u1, u2}};
  result.s[0] = dot(u0, b.c[0]);
  result.s[1] = dot(u1, b.c[1]);
  result.s[2] = dot(u2, b.c[2]);
  return result;
}

struct Limit {
  Doubles energy, first, second;
};

/// t^3 / (1 - t) up to 0.95, its quadratic Taylor polynomial beyond.
inline Limit onset(Doubles t) {
  const Doubles zero{};
  const Doubles t0 = max(min(t, splat(0.95)), zero);
  const Doubles q = 1.0 / (1.0 - t0);
  const Doubles beyond = max(t - t0, zero);
  Limit v;
  v.second = t0 * (6.0 - 6.0 * t0 + 2.0 * t0 * t0) * q * q * q;
  const Doubles first = t0 * t0 * (3.0 - 2.0 * t0) * q * q;
  v.energy = t0 * t0 * t0 * q + beyond * (first + 0.5 * beyond * v.second);
  v.first = first + beyond * v.second;
  return v;
}

inline Limit limit_at(const ElementLimits& limits, Doubles s) {
  const double w = limits.width;
  const Limit upper = onset((s - (limits.max - w)) * (1.0 / w));
  const Limit lower = onset(((limits.min + w) - s) * (1.0 / w));
  const double k = limits.stiffness;
  return {(k * w * w) * (upper.energy + lower.energy), (k * w) * (upper.first - lower.first),
          k * (upper.second + lower.second)};
}

double energy_gradient(const ElementGroup& group, const ElementLimits& limits,
                       const double* positions, ElementDecomposition* decomposition,
                       ElementForces* forces) {
  double group_energy = 0.0;
  for (int first = 0; first < kLanes; first += kWide) {
    Vec3 x[4];
    for (int a = 0; a < 4; ++a) x[a] = gather<Doubles>(group, a, first, positions);
    // F = sum_a (x_a - x_0) (grad N_a)^T
    Vec3 shape[3];
    Mat3 f{};
    for (int a = 0; a < 3; ++a) {
      shape[a] = {load(group.shape[a][0] + first), load(group.shape[a][1] + first),
                  load(group.shape[a][2] + first)};
      const Vec3 edge = x[a + 1] - x[0];
      f.c[0] = f.c[0] + edge * shape[a].x;
      f.c[1] = f.c[1] + edge * shape[a].y;
      f.c[2] = f.c[2] + edge * shape[a].z;
    }
    const Svd svd = decompose(f, load_matrix<Doubles>(decomposition->v, first));
    store_matrix(decomposition->v, first, svd.v);
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < kWide; ++i) {
        decomposition->u[3 * c][first + i] = static_cast<float>(svd.u.c[c].x[i]);
        decomposition->u[3 * c + 1][first + i] = static_cast<float>(svd.u.c[c].y[i]);
        decomposition->u[3 * c + 2][first + i] = static_cast<float>(svd.u.c[c].z[i]);
      }
    }
    const Doubles mu = load(group.mu + first);
    const Doubles lambda = load(group.lambda + first);
    const Doubles volume = load(group.volume + first);
    const Doubles trace = (svd.s[0] - 1.0) + (svd.s[1] - 1.0) + (svd.s[2] - 1.0);
    Doubles energy = 0.5 * lambda * trace * trace;
    Mat3 stressed = svd.u;  // U diag(p) volume
    for (int i = 0; i < 3; ++i) {
      store(decomposition->s[i] + first, svd.s[i]);
      const Doubles stretch = svd.s[i] - 1.0;
      Doubles p = 2.0 * mu * stretch + lambda * trace;
      energy += mu * stretch * stretch;
      if (limits.stiffness > 0.0) {
        const Limit b = limit_at(limits, svd.s[i]);
        energy += b.energy;
        p += b.first;
        store(decomposition->limit_stress[i] + first, b.first);
        store(decomposition->limit_stiffness[i] + first, b.second);
      }
      stressed.c[i] = stressed.c[i] * (p * volume);
    }
    Vec3 total{};
    for (int a = 0; a < 3; ++a) {
      const Vec3 g = stressed * transpose_times(svd.v, shape[a]);
      store(forces->force[a + 1][0] + first, g.x);
      store(forces->force[a + 1][1] + first, g.y);
      store(forces->force[a + 1][2] + first, g.z);
      total = total + g;
    }
    store(forces->force[0][0] + first, -total.x);
    store(forces->force[0][1] + first, -total.y);
    store(forces->force[0][2] + first, -total.z);
    energy *= volume;
    for (int i = 0; i < kWide; ++i) group_energy += energy[i];
  }
  return group_energy;
}

/// Closed-form eigen-modes of an isotropic energy in the frame of the decomposition (Smith, de
/// Goes, Kim, "Analytic eigensystems for isotropic distortion energies", TOG 2019): a 3 x 3 block
/// of the stretches and, for each pair of axes, a flip and a twist mode.
struct Modes {
  Floats shared;       ///< coefficient of (ii, jj)
  Floats stretch[3];   ///< coefficient of (ii, ii)
  Floats same[3][3];   ///< coefficient of (ij, ij)
  Floats mixed[3][3];  ///< coefficient of (ij, ji)
};

inline Modes modes_at(const ElementGroup& group, const ElementDecomposition& d, bool projected) {
  // Differences of nearly equal numbers: in double precision, then rounded.
  alignas(64) double stretch[3][kLanes], same[3][kLanes], mixed[3][kLanes];
  for (int first = 0; first < kLanes; first += kWide) {
    const Doubles mu = load(group.mu + first);
    const Doubles lambda = load(group.lambda + first);
    const Doubles volume = load(group.volume + first);
    Doubles s[3], b1[3], b2[3], p[3];
    for (int i = 0; i < 3; ++i) s[i] = load(d.s[i] + first);
    const Doubles trace = (s[0] - 1.0) + (s[1] - 1.0) + (s[2] - 1.0);
    for (int i = 0; i < 3; ++i) {
      b1[i] = load(d.limit_stress[i] + first);
      b2[i] = load(d.limit_stiffness[i] + first);
      p[i] = 2.0 * mu * (s[i] - 1.0) + lambda * trace + b1[i];
      store(stretch[i] + first, (2.0 * mu + lambda + b2[i]) * volume);
    }
    for (int k = 0; k < 3; ++k) {  // the pair of axes without k
      const int i = k == 0 ? 1 : 0;
      const int j = k == 2 ? 1 : 2;
      const Doubles difference = s[i] - s[j];  // not negative: the stretches are sorted
      const Mask close = difference < 1e-4;
      const Doubles slope = select(close, 0.5 * (b2[i] + b2[j]),
                                   (b1[i] - b1[j]) / select(close, splat(1.0), difference));
      const Doubles flip = 2.0 * mu + slope;
      Doubles twist = (p[i] + p[j]) / max(s[i] + s[j], splat(1e-3));
      if (projected) twist = max(twist, Doubles{});
      store(same[k] + first, 0.5 * (flip + twist) * volume);
      store(mixed[k] + first, 0.5 * (flip - twist) * volume);
    }
  }
  Modes m;
  m.shared = load_as_floats(group.lambda) * load_as_floats(group.volume);
  for (int k = 0; k < 3; ++k) {
    const int i = k == 0 ? 1 : 0;
    const int j = k == 2 ? 1 : 2;
    m.stretch[k] = load_as_floats(stretch[k]);
    m.same[i][j] = m.same[j][i] = load_as_floats(same[k]);
    m.mixed[i][j] = m.mixed[j][i] = load_as_floats(mixed[k]);
  }
  return m;
}

/// Place of block (a, b) in ElementHessians; (b, a), its transpose, shares it.
constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

void hessian(const ElementGroup& group, const ElementDecomposition& decomposition, bool projected,
             ElementHessians* hessians) {
  const Modes m = modes_at(group, decomposition, projected);
  const Mat<Floats> u = load_matrix<Floats>(decomposition.u, 0);
  Floats shape[3][3];  // V^T grad N_a
  {
    Mat<Floats> v;
    for (int c = 0; c < 3; ++c) {
      v.c[c] = {load_as_floats(decomposition.v[3 * c]), load_as_floats(decomposition.v[3 * c + 1]),
                load_as_floats(decomposition.v[3 * c + 2])};
    }
    for (int a = 0; a < 3; ++a) {
      const Vec<Floats> w =
          transpose_times(v, {load_as_floats(group.shape[a][0]), load_as_floats(group.shape[a][1]),
                              load_as_floats(group.shape[a][2])});
      shape[a][0] = w.x;
      shape[a][1] = w.y;
      shape[a][2] = w.z;
    }
  }
  Mat<Floats> row_sum[3] = {};  // sum over a of block (a, b)
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Floats* p = shape[a];
      const Floats* q = shape[b];
      Floats entry[3][3];  // block in the frame of U
      for (int i = 0; i < 3; ++i) {
        Floats diagonal = m.stretch[i] * p[i] * q[i];
        for (int j = 0; j < 3; ++j) {
          if (j == i) continue;
          diagonal += m.same[i][j] * p[j] * q[j];
          entry[i][j] = m.shared * p[i] * q[j] + m.mixed[i][j] * p[j] * q[i];
        }
        entry[i][i] = diagonal;
      }
      Mat<Floats> k;
      for (int c = 0; c < 3; ++c) k.c[c] = {entry[0][c], entry[1][c], entry[2][c]};
      const Mat<Floats> block = u * k * transpose(u);
      store_matrix(hessians->block[kPlace[a + 1][b + 1]], 0, block);
      row_sum[b] = row_sum[b] + block;
      if (a != b) row_sum[a] = row_sum[a] + transpose(block);
    }
  }
  Mat<Floats> corner{};
  for (int b = 0; b < 3; ++b) {
    store_matrix(hessians->block[kPlace[0][b + 1]], 0, row_sum[b] * (Floats{} - 1.0F));
    corner = corner + row_sum[b];
  }
  store_matrix(hessians->block[kPlace[0][0]], 0, corner);
}

inline void add_matrix(float p[9][kLanes], const Mat<Floats>& m) {
  store_matrix(p, 0, load_matrix<Floats>(p, 0) + m);
}

void body_hessian(const ElementGroup& group, const double* lever_arms,
                  const ElementHessians& hessians, ElementBodyHessians* rows,
                  BodyHessianSums* sums) {
  Vec<Floats> arm[4];
  Floats tied[4];
  for (int a = 0; a < 4; ++a) {
    arm[a] = gather<Floats>(group, a, 0, lever_arms);
    tied[a] = load_as_floats(group.tied[a]);
  }
  Mat<Floats> by_c{}, by_c_theta{}, by_theta{};
  for (int a = 0; a < 4; ++a) {
    Mat<Floats> translation{}, rotation{};
    for (int b = 0; b < 4; ++b) {
      const Mat<Floats> stored = load_matrix<Floats>(hessians.block[kPlace[a][b]], 0);
      const Mat<Floats> k = (a <= b ? stored : transpose(stored)) * tied[b];
      translation = translation + k;
      // K [-r]x, column by column
      rotation.c[0] = rotation.c[0] + k.c[2] * arm[b].y - k.c[1] * arm[b].z;
      rotation.c[1] = rotation.c[1] + k.c[0] * arm[b].z - k.c[2] * arm[b].x;
      rotation.c[2] = rotation.c[2] + k.c[1] * arm[b].x - k.c[0] * arm[b].y;
    }
    store_matrix(rows->by_translation[a], 0, translation);
    store_matrix(rows->by_rotation[a], 0, rotation);
    translation = translation * tied[a];
    rotation = rotation * tied[a];
    by_c = by_c + translation;
    by_c_theta = by_c_theta + rotation;
    for (int c = 0; c < 3; ++c) by_theta.c[c] = by_theta.c[c] + cross(arm[a], rotation.c[c]);
  }
  add_matrix(sums->translation, by_c);
  add_matrix(sums->translation_rotation, by_c_theta);
  add_matrix(sums->rotation, by_theta);
}

}  // namespace

extern const ElementKernels kElementKernels;
const ElementKernels kElementKernels{&energy_gradient, &hessian, &body_hessian};

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
