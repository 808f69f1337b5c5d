// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: the linker may keep either copy.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

// One double per element of a group; comparisons give all-ones or all-zeros lanes.
typedef double Lane __attribute__((vector_size(32), may_alias));
typedef long long Mask __attribute__((vector_size(32)));

static_assert(kLanes == 4);

inline Lane load(const double* p) { return *reinterpret_cast<const Lane*>(p); }
inline void store(double* p, Lane v) { *reinterpret_cast<Lane*>(p) = v; }
inline Lane splat(double v) { return Lane{v, v, v, v}; }
inline Lane select(Mask m, Lane a, Lane b) { return m ? a : b; }
inline Lane max(Lane a, Lane b) { return a > b ? a : b; }
inline Lane min(Lane a, Lane b) { return a < b ? a : b; }
inline Lane abs(Lane a) { return a < 0.0 ? -a : a; }
inline Lane sqrt(Lane a) {
  Lane r;
  for (int i = 0; i < kLanes; ++i) r[i] = __builtin_sqrt(a[i]);
  return r;
}
inline bool any(Mask m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }
inline double sum(Lane a) { return (a[0] + a[1]) + (a[2] + a[3]); }

struct Vec3 {
  Lane x, y, z;
};
inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(Vec3 a, Lane f) { return {a.x * f, a.y * f, a.z * f}; }
inline Lane dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3 select(Mask m, Vec3 a, Vec3 b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// 3 x 3 matrix by columns.
struct Mat3 {
  Vec3 c[3];
};
inline Vec3 operator*(const Mat3& m, Vec3 v) { return m.c[0] * v.x + m.c[1] * v.y + m.c[2] * v.z; }
inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  return {{a * b.c[0], a * b.c[1], a * b.c[2]}};
}
inline Vec3 transpose_times(const Mat3& m, Vec3 v) {
  return {dot(m.c[0], v), dot(m.c[1], v), dot(m.c[2], v)};
}

inline Mat3 load_matrix(const double p[9][kLanes]) {
  Mat3 m;
  for (int c = 0; c < 3; ++c) m.c[c] = {load(p[3 * c]), load(p[3 * c + 1]), load(p[3 * c + 2])};
  return m;
}
inline void store_matrix(double p[9][kLanes], const Mat3& m) {
  for (int c = 0; c < 3; ++c) {
    store(p[3 * c], m.c[c].x);
    store(p[3 * c + 1], m.c[c].y);
    store(p[3 * c + 2], m.c[c].z);
  }
}
inline Vec3 load_shape(const ElementGroup& group, int a) {
  return {load(group.shape[a][0]), load(group.shape[a][1]), load(group.shape[a][2])};
}

/// One Jacobi rotation that zeroes h, the inner product of columns p and q of B = F V; applied to
/// both B and V. One-sided (Hestenes 1958), so small stretches keep their accuracy.
inline void rotate(Vec3& bp, Vec3& bq, Vec3& vp, Vec3& vq, Lane h) {
  const Lane d = dot(bq, bq) - dot(bp, bp);
  const Lane h2 = h + h;
  const Lane denominator = abs(d) + sqrt(d * d + h2 * h2) + 1e-300;
  const Lane t = select(d < 0.0, -h2, h2) / denominator;
  const Lane c = 1.0 / sqrt(1.0 + t * t);
  const Lane s = t * c;
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
  const Lane zero{};
  const Vec3 axis{select(along_x, zero, splat(1.0)), select(along_x, splat(1.0), zero), zero};
  const Vec3 p = cross(a, axis);
  return p * (1.0 / sqrt(dot(p, p)));
}

struct Svd {
  Mat3 u, v;
  Lane s[3];
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
    const Lane h01 = dot(b.c[0], b.c[1]);
    const Lane h02 = dot(b.c[0], b.c[2]);
    const Lane h12 = dot(b.c[1], b.c[2]);
    const Lane off = abs(h01) + abs(h02) + abs(h12);
    const Lane scale = dot(b.c[0], b.c[0]) + dot(b.c[1], b.c[1]) + dot(b.c[2], b.c[2]);
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
  const Lane n0 = sqrt(dot(b.c[0], b.c[0]));
  const Mask collapsed = n0 < 1e-12;
  const Lane zero{};
  const Vec3 x_axis{splat(1.0), zero, zero};
  const Vec3 u0 = select(collapsed, x_axis, b.c[0] * (1.0 / max(n0, splat(1e-12))));
  const Vec3 p1 = b.c[1] - u0 * dot(u0, b.c[1]);
  const Lane n1 = sqrt(dot(p1, p1));
  const Vec3 u1 = select(n1 < 1e-12, any_perpendicular(u0), p1 * (1.0 / max(n1, splat(1e-12))));
  const Vec3 u2 = cross(u0, u1);
  result.u = {{u0, u1, u2}};
  result.s[0] = dot(u0, b.c[0]);
  result.s[1] = dot(u1, b.c[1]);
  result.s[2] = dot(u2, b.c[2]);
  return result;
}

struct Limit {
  Lane energy, first, second;
};

/// t^3 / (1 - t) up to 0.95, its quadratic Taylor polynomial beyond.
inline Limit onset(Lane t) {
  const Lane zero{};
  const Lane t0 = max(min(t, splat(0.95)), zero);
  const Lane q = 1.0 / (1.0 - t0);
  const Lane beyond = max(t - t0, zero);
  Limit v;
  v.second = t0 * (6.0 - 6.0 * t0 + 2.0 * t0 * t0) * q * q * q;
  const Lane first = t0 * t0 * (3.0 - 2.0 * t0) * q * q;
  v.energy = t0 * t0 * t0 * q + beyond * (first + 0.5 * beyond * v.second);
  v.first = first + beyond * v.second;
  return v;
}

inline Limit limit_at(const ElementLimits& limits, Lane s) {
  const double w = limits.width;
  const Limit upper = onset((s - (limits.max - w)) * (1.0 / w));
  const Limit lower = onset(((limits.min + w) - s) * (1.0 / w));
  const double k = limits.stiffness;
  return {(k * w * w) * (upper.energy + lower.energy), (k * w) * (upper.first - lower.first),
          k * (upper.second + lower.second)};
}

/// A vector of each of the elements' nodes a, stored x y z node by node.
inline Vec3 gather(const ElementGroup& group, int a, const double* vectors) {
  Vec3 v;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double* p = vectors + 3 * group.nodes[a][lane];
    v.x[lane] = p[0];
    v.y[lane] = p[1];
    v.z[lane] = p[2];
  }
  return v;
}

double energy_gradient(const ElementGroup& group, const ElementLimits& limits,
                       const double* positions, ElementDecomposition* decomposition,
                       ElementForces* forces) {
  Vec3 x[4];
  for (int a = 0; a < 4; ++a) x[a] = gather(group, a, positions);
  // F = sum_a (x_a - x_0) (grad N_a)^T
  Vec3 shape[3];
  Mat3 f{};
  for (int a = 0; a < 3; ++a) {
    shape[a] = load_shape(group, a);
    const Vec3 edge = x[a + 1] - x[0];
    f.c[0] = f.c[0] + edge * shape[a].x;
    f.c[1] = f.c[1] + edge * shape[a].y;
    f.c[2] = f.c[2] + edge * shape[a].z;
  }
  const Svd svd = decompose(f, load_matrix(decomposition->v));
  store_matrix(decomposition->u, svd.u);
  store_matrix(decomposition->v, svd.v);
  const Lane mu = load(group.mu);
  const Lane lambda = load(group.lambda);
  const Lane volume = load(group.volume);
  const Lane trace = (svd.s[0] - 1.0) + (svd.s[1] - 1.0) + (svd.s[2] - 1.0);
  Lane energy = 0.5 * lambda * trace * trace;
  Mat3 stressed = svd.u;  // U diag(p) volume
  for (int i = 0; i < 3; ++i) {
    store(decomposition->s[i], svd.s[i]);
    const Lane stretch = svd.s[i] - 1.0;
    Lane p = 2.0 * mu * stretch + lambda * trace;
    energy += mu * stretch * stretch;
    if (limits.stiffness > 0.0) {
      const Limit b = limit_at(limits, svd.s[i]);
      energy += b.energy;
      p += b.first;
    }
    stressed.c[i] = stressed.c[i] * (p * volume);
  }
  Vec3 total{};
  for (int a = 0; a < 3; ++a) {
    const Vec3 g = stressed * transpose_times(svd.v, shape[a]);
    store(forces->force[a + 1][0], g.x);
    store(forces->force[a + 1][1], g.y);
    store(forces->force[a + 1][2], g.z);
    total = total + g;
  }
  store(forces->force[0][0], -total.x);
  store(forces->force[0][1], -total.y);
  store(forces->force[0][2], -total.z);
  return sum(energy * volume);
}

/// Closed-form eigen-modes of an isotropic energy in the frame of the decomposition (Smith, de
/// Goes, Kim, "Analytic eigensystems for isotropic distortion energies", TOG 2019): a 3 x 3 block
/// of the stretches and, for each pair of axes, a flip and a twist mode.
struct Modes {
  Lane stretch[3][3];
  Lane same[3][3];   ///< coefficient of (ij, ij)
  Lane mixed[3][3];  ///< coefficient of (ij, ji)
};

inline Modes modes_at(const ElementGroup& group, const ElementLimits& limits, const Lane s[3],
                      bool projected) {
  const Lane mu = load(group.mu);
  const Lane lambda = load(group.lambda);
  const Lane volume = load(group.volume);
  const Lane trace = (s[0] - 1.0) + (s[1] - 1.0) + (s[2] - 1.0);
  Limit b[3] = {};
  Lane p[3];
  for (int i = 0; i < 3; ++i) {
    if (limits.stiffness > 0.0) b[i] = limit_at(limits, s[i]);
    p[i] = 2.0 * mu * (s[i] - 1.0) + lambda * trace + b[i].first;
  }
  Modes m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m.stretch[i][j] = lambda * volume;
    m.stretch[i][i] += (2.0 * mu + b[i].second) * volume;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 3; ++j) {
      const Lane difference = s[i] - s[j];  // not negative: the stretches are sorted
      const Mask close = difference < 1e-4;
      const Lane slope = select(close, 0.5 * (b[i].second + b[j].second),
                                (b[i].first - b[j].first) / select(close, splat(1.0), difference));
      const Lane flip = 2.0 * mu + slope;
      Lane twist = (p[i] + p[j]) / max(s[i] + s[j], splat(1e-3));
      if (projected) twist = max(twist, Lane{});
      m.same[i][j] = m.same[j][i] = 0.5 * (flip + twist) * volume;
      m.mixed[i][j] = m.mixed[j][i] = 0.5 * (flip - twist) * volume;
    }
  }
  return m;
}

void hessian(const ElementGroup& group, const ElementLimits& limits,
             const ElementDecomposition& decomposition, bool projected, ElementHessians* hessians) {
  const Mat3 u = load_matrix(decomposition.u);
  const Mat3 v = load_matrix(decomposition.v);
  const Lane s[3] = {load(decomposition.s[0]), load(decomposition.s[1]), load(decomposition.s[2])};
  const Modes m = modes_at(group, limits, s, projected);
  Lane shape[3][3];  // V^T grad N_a
  for (int a = 0; a < 3; ++a) {
    const Vec3 w = transpose_times(v, load_shape(group, a));
    shape[a][0] = w.x;
    shape[a][1] = w.y;
    shape[a][2] = w.z;
  }
  // Places of (a, b), 1 <= a <= b <= 3, and of (0, b) in ElementHessians.
  constexpr int kPlace[3][3] = {{4, 5, 6}, {5, 7, 8}, {6, 8, 9}};
  Lane row_sum[3][9] = {};  // sum over a of block (a, b)
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Lane* p = shape[a];
      const Lane* q = shape[b];
      Mat3 k;  // block in the frame of U
      Lane entry[3][3];
      for (int i = 0; i < 3; ++i) {
        Lane diagonal = m.stretch[i][i] * p[i] * q[i];
        for (int j = 0; j < 3; ++j) {
          if (j == i) continue;
          diagonal += m.same[i][j] * p[j] * q[j];
          entry[i][j] = m.stretch[i][j] * p[i] * q[j] + m.mixed[i][j] * p[j] * q[i];
        }
        entry[i][i] = diagonal;
      }
      for (int c = 0; c < 3; ++c) k.c[c] = {entry[0][c], entry[1][c], entry[2][c]};
      const Mat3 w = u * k;
      // (U K) U^T: column c is the sum over j of w_j times u_cj.
      Lane full[9];
      for (int c = 0; c < 3; ++c) {
        Vec3 column{};
        for (int j = 0; j < 3; ++j) {
          const Lane factor = c == 0 ? u.c[j].x : c == 1 ? u.c[j].y : u.c[j].z;
          column = column + w.c[j] * factor;
        }
        full[3 * c] = column.x;
        full[3 * c + 1] = column.y;
        full[3 * c + 2] = column.z;
      }
      for (int e = 0; e < 9; ++e) {
        store(hessians->block[kPlace[a][b]][e], full[e]);
        row_sum[b][e] += full[e];
        // Block (b, a) is the transpose of (a, b).
        if (a != b) row_sum[a][e] += full[3 * (e % 3) + e / 3];
      }
    }
  }
  for (int e = 0; e < 9; ++e) {
    Lane corner{};
    for (int b = 0; b < 3; ++b) {
      store(hessians->block[1 + b][e], -row_sum[b][e]);
      corner += row_sum[b][e];
    }
    store(hessians->block[0][e], corner);
  }
}

inline Mat3 transpose(const Mat3& m) {
  return {{{m.c[0].x, m.c[1].x, m.c[2].x},
           {m.c[0].y, m.c[1].y, m.c[2].y},
           {m.c[0].z, m.c[1].z, m.c[2].z}}};
}
inline Mat3 operator+(const Mat3& a, const Mat3& b) {
  return {{a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}};
}
inline Mat3 operator*(const Mat3& m, Lane f) { return {{m.c[0] * f, m.c[1] * f, m.c[2] * f}}; }
inline void add_matrix(double p[9][kLanes], const Mat3& m) { store_matrix(p, load_matrix(p) + m); }

void body_hessian(const ElementGroup& group, const double* lever_arms,
                  const ElementHessians& hessians, ElementBodyHessians* rows,
                  BodyHessianSums* sums) {
  constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
  Vec3 arm[4];
  Lane tied[4];
  for (int a = 0; a < 4; ++a) {
    arm[a] = gather(group, a, lever_arms);
    tied[a] = load(group.tied[a]);
  }
  Mat3 by_c{}, by_c_theta{}, by_theta{};
  for (int a = 0; a < 4; ++a) {
    Mat3 translation{}, rotation{};
    for (int b = 0; b < 4; ++b) {
      const Mat3 stored = load_matrix(hessians.block[kPlace[a][b]]);
      const Mat3 k = (a <= b ? stored : transpose(stored)) * tied[b];
      translation = translation + k;
      // K [-r]x, column by column
      rotation.c[0] = rotation.c[0] + k.c[2] * arm[b].y - k.c[1] * arm[b].z;
      rotation.c[1] = rotation.c[1] + k.c[0] * arm[b].z - k.c[2] * arm[b].x;
      rotation.c[2] = rotation.c[2] + k.c[1] * arm[b].x - k.c[0] * arm[b].y;
    }
    store_matrix(rows->by_translation[a], translation);
    store_matrix(rows->by_rotation[a], rotation);
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
