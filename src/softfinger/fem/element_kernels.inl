// Compiled once per instruction set, in a namespace of its own. Includes nothing whose inline
// functions another translation unit could share: of two copies of one function the linker keeps
// either, and the kept one might be made for a processor that this is not. The constitutive law
// and strain limits are templates over the arithmetic, which here is a type of the unnamed
// namespace: what is made of them has no linkage either and is never shared.

#ifndef SOFTFINGER_KERNEL_NAMESPACE
#error "define SOFTFINGER_KERNEL_NAMESPACE"
#endif

namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE {
namespace {

// Gradients in double precision, half a group at a time; second derivatives, which only steer the
// iteration, in single precision for the whole group. Comparisons give all-ones or all-zeros lanes.
constexpr int kWide = 4;
static_assert(kLanes == 2 * kWide);
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
inline void store_as_floats(float* p, Doubles v) {
  for (int i = 0; i < kWide; ++i) p[i] = static_cast<float>(v[i]);
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

/// What laws and strain limits are worked out in, see constitutive_law.hpp.
template <typename Vector>
struct LaneArithmetic {
  using Number = Vector;
  using Lane = std::remove_cvref_t<decltype(Vector{}[0])>;
  static Vector all(double x) { return Vector{} + static_cast<Lane>(x); }
  static Vector min(Vector a, Vector b) { return a < b ? a : b; }
  static Vector max(Vector a, Vector b) { return a > b ? a : b; }
  template <typename Condition>
  static Vector select(Condition condition, Vector a, Vector b) {
    return condition ? a : b;
  }
  static Vector quotient(Vector a, double w) { return a * static_cast<Lane>(1.0 / w); }
  static Vector sum_of_strains(const Vector (&s)[3]) {
    return (s[0] - all(1.0)) + (s[1] - all(1.0)) + (s[2] - all(1.0));
  }
};

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

/// Inner products of the columns of F V.
struct Gram {
  Doubles d0, d1, d2, h01, h02, h12;
  explicit Gram(const Mat3& b)
      : d0(dot(b.c[0], b.c[0])),
        d1(dot(b.c[1], b.c[1])),
        d2(dot(b.c[2], b.c[2])),
        h01(dot(b.c[0], b.c[1])),
        h02(dot(b.c[0], b.c[2])),
        h12(dot(b.c[1], b.c[2])) {}
  /// Perpendicular to rounding is enough.
  [[nodiscard]] Mask unfinished() const {
    return abs(h01) + abs(h02) + abs(h12) > 1e-13 * (d0 + d1 + d2);
  }
};

inline void turn(Doubles& p, Doubles& q, Doubles c, Doubles s) {
  const Doubles turned = p * c - q * s;
  q = p * s + q * c;
  p = turned;
}

/// Jacobi rotation that zeroes h, the inner product of columns p and q; r is the third column.
inline void rotate(Doubles& dp, Doubles& dq, Doubles& h, Doubles& hpr, Doubles& hqr, Vec3& vp,
                   Vec3& vq) {
  const Doubles d = dq - dp;
  const Doubles h2 = h + h;
  // The smaller of the two angles, from a tangent that cancels nowhere; no 0/0 where h is zero.
  const Doubles denominator = abs(d) + sqrt(d * d + h2 * h2) + 1e-300;
  const Doubles t = select(d < 0.0, -h2, h2) / denominator;
  const Doubles c = 1.0 / sqrt(1.0 + t * t);
  const Doubles s = t * c;
  dp = dp - t * h;
  dq = dq + t * h;
  h = Doubles{};
  turn(hpr, hqr, c, s);
  turn(vp.x, vq.x, c, s);
  turn(vp.y, vq.y, c, s);
  turn(vp.z, vq.z, c, s);
}

inline void swap_where(Mask m, Doubles& p, Doubles& q) {
  const Doubles kept = select(m, q, p);
  // Negating one of the two keeps det V = 1.
  q = select(m, -p, q);
  p = kept;
}

inline void sort_pair(Vec3& bp, Vec3& bq, Vec3& vp, Vec3& vq) {
  const Mask swap = dot(bp, bp) < dot(bq, bq);
  swap_where(swap, bp.x, bq.x);
  swap_where(swap, bp.y, bq.y);
  swap_where(swap, bp.z, bq.z);
  swap_where(swap, vp.x, vq.x);
  swap_where(swap, vp.y, vq.y);
  swap_where(swap, vp.z, vq.z);
}

inline Vec3 any_perpendicular(Vec3 a) {
  const Mask along_x = abs(a.x) > 0.7;
  const Doubles zero{};
  const Vec3 axis{select(along_x, zero, splat(1.0)), select(along_x, splat(1.0), zero), zero};
  const Vec3 p = cross(a, axis);
  return p * (1.0 / sqrt(dot(p, p)));
}

/// Turns v0 and v1 so that the columns of F0 v0 and F1 v1 are perpendicular (Jacobi's method on
/// their inner products). Two at once: one's square roots and quotients hide behind the other's.
inline void diagonalise(const Mat3& f0, Mat3& v0, Mat3& b0, const Mat3& f1, Mat3& v1, Mat3& b1) {
  constexpr int kMaxSweeps = 12;
  b0 = f0 * v0;
  b1 = f1 * v1;
  Gram g0(b0);
  Gram g1(b1);
  for (int sweep = 0; sweep < kMaxSweeps && any(g0.unfinished() | g1.unfinished()); ++sweep) {
    rotate(g0.d0, g0.d1, g0.h01, g0.h02, g0.h12, v0.c[0], v0.c[1]);
    rotate(g1.d0, g1.d1, g1.h01, g1.h02, g1.h12, v1.c[0], v1.c[1]);
    rotate(g0.d0, g0.d2, g0.h02, g0.h01, g0.h12, v0.c[0], v0.c[2]);
    rotate(g1.d0, g1.d2, g1.h02, g1.h01, g1.h12, v1.c[0], v1.c[2]);
    rotate(g0.d1, g0.d2, g0.h12, g0.h01, g0.h02, v0.c[1], v0.c[2]);
    rotate(g1.d1, g1.d2, g1.h12, g1.h01, g1.h02, v1.c[1], v1.c[2]);
  }
  // Anew, since rotating Gram's numbers alone has let rounding pile up.
  b0 = f0 * v0;
  b1 = f1 * v1;
}

inline void sort(Mat3& b, Mat3& v) {
  sort_pair(b.c[0], b.c[1], v.c[0], v.c[1]);
  sort_pair(b.c[0], b.c[2], v.c[0], v.c[2]);
  sort_pair(b.c[1], b.c[2], v.c[1], v.c[2]);
}

/// U of b = F v = U diag(s), det U = 1: a negative determinant becomes a negative last s.
inline void left_vectors(const Mat3& b, Vec3& u0, Vec3& u1, Vec3& u2) {
  const Doubles n0 = sqrt(dot(b.c[0], b.c[0]));
  // Squeezed to a point or a line: any direction does, since no stress picks one.
  const Mask collapsed = n0 < 1e-12;
  const Doubles zero{};
  const Vec3 x_axis{splat(1.0), zero, zero};
  u0 = select(collapsed, x_axis, b.c[0] * (1.0 / max(n0, splat(1e-12))));
  const Vec3 p1 = b.c[1] - u0 * dot(u0, b.c[1]);
  const Doubles n1 = sqrt(dot(p1, p1));
  u1 = p1 * (1.0 / max(n1, splat(1e-12)));
  if (any(n1 < 1e-12)) u1 = select(n1 < 1e-12, any_perpendicular(u0), u1);
  u2 = cross(u0, u1);
}

/// A warm start drifts from a rotation by rounding: one Newton-Schulz step renews it.
inline Mat3 renewed(const Mat3& v) {
  Mat3 r;
  for (int c = 0; c < 3; ++c) {
    const Vec3 w = transpose_times(v, v.c[c]);
    r.c[c] = v.c[c] * splat(1.5) - (v * w) * splat(0.5);
  }
  return r;
}

inline Vec3 load_shape(const ElementGroup& group, int a, int first) {
  return {load(group.shape[a][0] + first), load(group.shape[a][1] + first),
          load(group.shape[a][2] + first)};
}

/// F = sum_a (x_a - x_0) (grad N_a)^T
inline Mat3 deformation_gradient(const ElementGroup& group, int first, const double* positions) {
  const Vec3 x0 = gather<Doubles>(group, 0, first, positions);
  Mat3 f{};
  for (int a = 0; a < 3; ++a) {
    const Vec3 shape = load_shape(group, a, first);
    const Vec3 edge = gather<Doubles>(group, a + 1, first, positions) - x0;
    f.c[0] = f.c[0] + edge * shape.x;
    f.c[1] = f.c[1] + edge * shape.y;
    f.c[2] = f.c[2] + edge * shape.z;
  }
  return f;
}

inline void store_as_floats(float p[][kLanes], int first, Vec3 v) {
  store_as_floats(p[0] + first, v.x);
  store_as_floats(p[1] + first, v.y);
  store_as_floats(p[2] + first, v.z);
}

/// Adds the strain limit's energy density and stress at stretch s; leaves its derivatives.
inline void add_limit(const StrainLimit& limit, Doubles s, int axis, int first,
                      ElementDecomposition* decomposition, Doubles& energy, Doubles& p) {
  if (limit.stiffness > 0.0) {
    const auto b = strain_limit_at<LaneArithmetic<Doubles>>(limit, s);
    energy += b.energy;
    p += b.first;
    store(decomposition->limit_stress[axis] + first, b.first);
    store(decomposition->limit_stiffness[axis] + first, b.second);
  } else {
    store(decomposition->limit_stress[axis] + first, Doubles{});
    store(decomposition->limit_stiffness[axis] + first, Doubles{});
  }
}

/// Symmetric 3 x 3 matrix.
struct Symmetric {
  Doubles xx, yy, zz, xy, xz, yz;
};
inline Symmetric load_symmetric(const ElementStress& stress, int first) {
  return {load(stress.part[0] + first), load(stress.part[1] + first), load(stress.part[2] + first),
          load(stress.part[3] + first), load(stress.part[4] + first), load(stress.part[5] + first)};
}
inline Vec3 operator*(const Symmetric& m, Vec3 v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

/// U times the derivative of H : S by F in the frame of the decomposition, plus U diag(p). With
/// M = U^T dF V the stretch tensor changes by (s_i M_ij + s_j M_ji) / (s_i + s_j) in that frame.
inline Mat3 with_memory(const Symmetric& memory, const Mat3& v, const Mat3& u, const Doubles p[3],
                        const Doubles s[3], int first, ElementDecomposition* decomposition,
                        Doubles& energy) {
  Doubles h[3][3];
  for (int j = 0; j < 3; ++j) {
    const Vec3 column = transpose_times(v, memory * v.c[j]);
    h[0][j] = column.x;
    h[1][j] = column.y;
    h[2][j] = column.z;
    for (int i = 0; i < 3; ++i) store(decomposition->memory_stress[i][j] + first, h[i][j]);
  }
  Mat3 result;
  for (int j = 0; j < 3; ++j) {
    energy += h[j][j] * (s[j] - 1.0);
    Vec3 column = u.c[j] * (p[j] + h[j][j]);
    for (int i = 0; i < 3; ++i) {
      if (i == j) continue;
      column = column + u.c[i] * (2.0 * h[i][j] * s[i] / max(s[i] + s[j], splat(1e-3)));
    }
    result.c[j] = column;
  }
  return result;
}

inline void store_force(double force[3][kLanes], int first, Vec3 g) {
  store(force[0] + first, g.x);
  store(force[1] + first, g.y);
  store(force[2] + first, g.z);
}

/// Energy of half a group from lane `first` on, its forces, and what the later passes need, where
/// the columns of b = F v are perpendicular.
template <template <typename> typename Law>
inline Doubles respond(const ElementGroup& group, const StrainLimit& limit,
                       const ElementViscosity& viscosity, int first, const Mat3& b, const Mat3& v,
                       ElementDecomposition* decomposition, ElementForces* forces,
                       ElementDilatation* dilatation) {
  Vec3 u0, u1, u2;
  left_vectors(b, u0, u1, u2);
  store_matrix(decomposition->v, first, v);
  store_as_floats(decomposition->u, first, u0);
  store_as_floats(decomposition->u + 3, first, u1);
  store_as_floats(decomposition->u + 6, first, u2);
  const Doubles s[3] = {dot(u0, b.c[0]), dot(u1, b.c[1]), dot(u2, b.c[2])};
  const Doubles volume = load(group.volume + first);
  using LaneLaw = Law<LaneArithmetic<Doubles>>;
  const Doubles dilated = LaneLaw::dilatation(s);
  const LaneLaw law(load(group.mu + first), load(group.lambda + first), s, dilated, Doubles{});
  Doubles energy = law.energy_of_dilatation();
  const auto stress_along = [&](int axis) {
    store(decomposition->s[axis] + first, s[axis]);
    Doubles p = law.stress(axis);
    energy += law.energy_along(axis);
    add_limit(limit, s[axis], axis, first, decomposition, energy, p);
    return viscosity.factor * p;
  };
  const Doubles p0 = stress_along(0);
  const Doubles p1 = stress_along(1);
  const Doubles p2 = stress_along(2);
  // What the past left is not scaled: it has relaxed already.
  energy = energy * viscosity.factor;
  Mat3 stressed{{u0 * (p0 * volume), u1 * (p1 * volume), u2 * (p2 * volume)}};
  if (viscosity.memory != nullptr) {
    const Doubles p[3] = {p0, p1, p2};
    stressed = with_memory(load_symmetric(*viscosity.memory, first), v, {{u0, u1, u2}}, p, s, first,
                           decomposition, energy) *
               volume;
  }
  const auto store_forces = [&](const Mat3& of, double(*force)[3][kLanes]) {
    const Vec3 g1 = of * transpose_times(v, load_shape(group, 0, first));
    const Vec3 g2 = of * transpose_times(v, load_shape(group, 1, first));
    const Vec3 g3 = of * transpose_times(v, load_shape(group, 2, first));
    store_force(force[0], first, (g1 + g2 + g3) * splat(-1.0));
    store_force(force[1], first, g1);
    store_force(force[2], first, g2);
    store_force(force[3], first, g3);
  };
  store_forces(stressed, forces->force);
  if (dilatation != nullptr) {
    store(dilatation->value + first, dilated * volume);
    store_forces({{u0 * (law.dilatation_slope(0) * volume), u1 * (law.dilatation_slope(1) * volume),
                   u2 * (law.dilatation_slope(2) * volume)}},
                 dilatation->force);
  }
  return energy * volume;
}

template <template <typename> typename Law>
[[gnu::flatten]] double energy_gradient(const ElementGroup& group, const StrainLimit& limit,
                                        const ElementViscosity& viscosity, const double* positions,
                                        ElementDecomposition* decomposition, ElementForces* forces,
                                        ElementDilatation* dilatation) {
  // The last evaluation's axes are nearly these: few sweeps are left.
  Mat3 v0 = renewed(load_matrix<Doubles>(decomposition->v, 0));
  Mat3 v1 = renewed(load_matrix<Doubles>(decomposition->v, kWide));
  Mat3 b0, b1;
  diagonalise(deformation_gradient(group, 0, positions), v0, b0,
              deformation_gradient(group, kWide, positions), v1, b1);
  // The order matters where a stretch is or might be negative: it must be the least.
  const Doubles det0 = dot(b0.c[0], cross(b0.c[1], b0.c[2]));
  const Doubles det1 = dot(b1.c[0], cross(b1.c[1], b1.c[2]));
  if (any(det0 < 0.01) || any(det1 < 0.01)) {
    sort(b0, v0);
    sort(b1, v1);
  }
  const Doubles energy0 =
      respond<Law>(group, limit, viscosity, 0, b0, v0, decomposition, forces, dilatation);
  const Doubles energy1 =
      respond<Law>(group, limit, viscosity, kWide, b1, v1, decomposition, forces, dilatation);
  double energy = 0.0;
  for (int i = 0; i < kWide; ++i) energy += energy0[i] + energy1[i];
  return energy;
}

/// Closed-form eigen-modes of an isotropic energy in the frame of the decomposition (Smith, de
/// Goes, Kim, "Analytic eigensystems for isotropic distortion energies", TOG 2019): a 3 x 3 block
/// of the stretches and, for each pair of axes, a flip and a twist mode.
struct Modes {
  Floats stretch[3];   ///< coefficient of (ii, ii)
  Floats across[3];    ///< coefficient of (ii, jj), by the axis that is neither
  Floats same[3][3];   ///< coefficient of (ij, ij)
  Floats mixed[3][3];  ///< coefficient of (ij, ji)
};

/// With `remembering` the past's stress is left to Memory, but where projected.
template <template <typename> typename Law>
inline Modes modes_at(const ElementGroup& group, double factor, const ElementDecomposition& d,
                      const double* pressures, bool remembering, bool projected) {
  // Differences of nearly equal numbers: in double precision, then rounded.
  alignas(64) double stretch[3][kLanes], same[3][kLanes], mixed[3][kLanes];
  for (int first = 0; first < kLanes; first += kWide) {
    const Doubles volume = load(group.volume + first);
    const Doubles pressure = load(pressures + first);
    Doubles s[3], b1[3], b2[3], p[3];
    for (int i = 0; i < 3; ++i) s[i] = load(d.s[i] + first);
    using LaneLaw = Law<LaneArithmetic<Doubles>>;
    const LaneLaw law(factor * load(group.mu + first), factor * load(group.lambda + first), s,
                      LaneLaw::dilatation(s), pressure);
    for (int i = 0; i < 3; ++i) {
      b1[i] = factor * load(d.limit_stress[i] + first);
      b2[i] = factor * load(d.limit_stiffness[i] + first);
      p[i] = law.stress(i) + pressure * law.dilatation_slope(i) + b1[i];
      if (remembering && projected) p[i] += load(d.memory_stress[i][i] + first);
      store(stretch[i] + first, (law.stiffness(i, i) + b2[i]) * volume);
    }
    for (int k = 0; k < 3; ++k) {  // the pair of axes without k
      const int i = k == 0 ? 1 : 0;
      const int j = k == 2 ? 1 : 2;
      const Doubles difference = s[i] - s[j];
      const Mask close = abs(difference) < 1e-4;
      // The quotient of stretches that are nearly equal is noise; the derivative is its limit.
      const Doubles slope = select(close, 0.5 * (b2[i] + b2[j]),
                                   (b1[i] - b1[j]) / select(close, splat(1.0), difference));
      const Doubles flip = law.flip(i, j) + slope;
      // It has a pole where a stretch turns negative; the bound keeps the direction finite.
      Doubles twist = (p[i] + p[j]) / max(s[i] + s[j], splat(1e-3));
      if (projected) twist = max(twist, Doubles{});
      store(same[k] + first, 0.5 * (flip + twist) * volume);
      store(mixed[k] + first, 0.5 * (flip - twist) * volume);
    }
  }
  const Floats s[3] = {load_as_floats(d.s[0]), load_as_floats(d.s[1]), load_as_floats(d.s[2])};
  using LaneLaw = Law<LaneArithmetic<Floats>>;
  const auto part = static_cast<float>(factor);
  const LaneLaw law(load_as_floats(group.mu), load_as_floats(group.lambda), s,
                    LaneLaw::dilatation(s), load_as_floats(pressures) / part);
  Modes m;
  for (int k = 0; k < 3; ++k) {
    const int i = k == 0 ? 1 : 0;
    const int j = k == 2 ? 1 : 2;
    m.stretch[k] = load_as_floats(stretch[k]);
    m.across[k] = law.stiffness(i, j) * load_as_floats(group.volume) * part;
    m.same[i][j] = m.same[j][i] = load_as_floats(same[k]);
    m.mixed[i][j] = m.mixed[j][i] = load_as_floats(mixed[k]);
  }
  return m;
}

/// Second derivative of V H : S by F, S the stretch tensor and H what is remembered. With G from
/// S G + G S = H, S^2 = F^T F gives d2(H : S) = 2 G : (dF^T dF - dS dS); in the frame of the
/// decomposition, G is H_ij / (s_i + s_j) and dS is (s_i M_ij + s_j M_ji) / (s_i + s_j).
struct Memory {
  Floats g[3][3];      ///< G times volume
  Floats share[3][3];  ///< s_i / (s_i + s_j)
};

inline Memory memory_at(const ElementGroup& group, const ElementDecomposition& d) {
  Memory m;
  const Floats volume = load_as_floats(group.volume);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Floats s = load_as_floats(d.s[i]);
      Floats sum = s + load_as_floats(d.s[j]);
      sum = sum > 1e-3F ? sum : Floats{} + 1e-3F;
      m.g[i][j] = load_as_floats(d.memory_stress[i][j]) * volume / sum;
      m.share[i][j] = s / sum;
    }
  }
  return m;
}

/// Adds its block of two nodes, V^T grad N of which are p and q, in the frame of U.
inline void add_memory(const Memory& m, const Floats* p, const Floats* q, Floats entry[3][3]) {
  // dS is e_i w_i^T + w_i e_i^T where a node moves along axis i.
  Floats w[3][3], v[3][3], gw[3][3], gv[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      w[i][k] = m.share[i][k] * p[k];
      v[i][k] = m.share[i][k] * q[k];
    }
    for (int k = 0; k < 3; ++k) {
      gw[i][k] = m.g[k][0] * w[i][0] + m.g[k][1] * w[i][1] + m.g[k][2] * w[i][2];
      gv[i][k] = m.g[k][0] * v[i][0] + m.g[k][1] * v[i][1] + m.g[k][2] * v[i][2];
    }
  }
  Floats across{};
  for (int k = 0; k < 3; ++k) {
    across += p[k] * (m.g[k][0] * q[0] + m.g[k][1] * q[1] + m.g[k][2] * q[2]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Floats both = w[i][0] * v[j][0] + w[i][1] * v[j][1] + w[i][2] * v[j][2];
      entry[i][j] -= 2.0F * (w[i][j] * gv[j][i] + both * m.g[i][j] + v[j][i] * gw[i][j]);
    }
    entry[i][i] += 2.0F * (across - (v[i][0] * gw[i][0] + v[i][1] * gw[i][1] + v[i][2] * gw[i][2]));
  }
}

/// Place of block (a, b) in ElementHessians; (b, a), its transpose, shares it.
constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

template <template <typename> typename Law>
void hessian(const ElementGroup& group, double factor, const ElementDecomposition& decomposition,
             const double* pressures, bool remembering, bool projected, ElementHessians* hessians) {
  const Modes m = modes_at<Law>(group, factor, decomposition, pressures, remembering, projected);
  const bool exact = remembering && !projected;
  const Memory memory = exact ? memory_at(group, decomposition) : Memory{};
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
          entry[i][j] = m.across[3 - i - j] * p[i] * q[j] + m.mixed[i][j] * p[j] * q[i];
        }
        entry[i][i] = diagonal;
      }
      if (exact) add_memory(memory, p, q, entry);
      Mat<Floats> k;
      for (int c = 0; c < 3; ++c) k.c[c] = {entry[0][c], entry[1][c], entry[2][c]};
      const Mat<Floats> block = u * k * transpose(u);
      store_matrix(hessians->block[kPlace[a + 1][b + 1]], 0, block);
      row_sum[b] = row_sum[b] + block;
      if (a != b) row_sum[a] = row_sum[a] + transpose(block);
    }
  }
  // Moving all four nodes alike changes nothing: the blocks of node 0 are minus the others' sums.
  Mat<Floats> corner{};
  for (int b = 0; b < 3; ++b) {
    store_matrix(hessians->block[kPlace[0][b + 1]], 0, row_sum[b] * (Floats{} - 1.0F));
    corner = corner + row_sum[b];
  }
  store_matrix(hessians->block[kPlace[0][0]], 0, corner);
}

/// V diag(p) V^T
template <template <typename> typename Law>
void elastic_stress(const ElementGroup& group, const ElementDecomposition& decomposition,
                    const double* pressures, ElementStress* stress) {
  for (int first = 0; first < kLanes; first += kWide) {
    const Mat3 v = load_matrix<Doubles>(decomposition.v, first);
    const Doubles pressure = load(pressures + first);
    Doubles s[3];
    for (int i = 0; i < 3; ++i) s[i] = load(decomposition.s[i] + first);
    using LaneLaw = Law<LaneArithmetic<Doubles>>;
    const LaneLaw law(load(group.mu + first), load(group.lambda + first), s, LaneLaw::dilatation(s),
                      pressure);
    Doubles sum[6] = {};
    for (int i = 0; i < 3; ++i) {
      const Doubles p = law.stress(i) + pressure * law.dilatation_slope(i) +
                        load(decomposition.limit_stress[i] + first);
      const Vec3& axis = v.c[i];
      sum[0] += p * axis.x * axis.x;
      sum[1] += p * axis.y * axis.y;
      sum[2] += p * axis.z * axis.z;
      sum[3] += p * axis.x * axis.y;
      sum[4] += p * axis.x * axis.z;
      sum[5] += p * axis.y * axis.z;
    }
    for (int k = 0; k < 6; ++k) store(stress->part[k] + first, sum[k]);
  }
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

template <template <typename> typename Law>
constexpr ElementKernels kernels_of() {
  return {&energy_gradient<Law>, &hessian<Law>, &elastic_stress<Law>, &body_hessian};
}

}  // namespace

extern const ElementKernels kElementKernels;
const ElementKernels kElementKernels = kernels_of<ConstitutiveLaw>();

}  // namespace softfinger::SOFTFINGER_KERNEL_NAMESPACE
