#pragma once

#include <cstddef>
#include <type_traits>

#include "softfinger/base/instruction_set.hpp"
#include "softfinger/fem/constitutive_law.hpp"
#include "softfinger/fem/strain_limit.hpp"

namespace softfinger {

/// Elements are worked on in groups of this many, one to a vector lane.
inline constexpr int kLanes = 8;
inline constexpr auto kLaneCount = static_cast<std::size_t>(kLanes);

/// Rest state of one group of linear tetrahedra. Lanes beyond the last element have volume 0.
struct ElementGroup {
  alignas(64) int nodes[4][kLanes];
  alignas(
      32) double shape[3][3][kLanes];  ///< shape[a][k]: component k of grad N_{a+1} at rest, 1/m
  alignas(64) double volume[kLanes];   ///< m^3
  alignas(64) double mu[kLanes];       ///< Pa
  alignas(64) double lambda[kLanes];   ///< Pa
  alignas(64) double tied[4][kLanes];  ///< 1 where the node moves with the rigid body, else 0
};

/// What the gradient pass leaves for the Hessian pass and, as a warm start, for the next one:
/// F = U diag(s) V^T with det U = det V = 1.
struct ElementDecomposition {
  alignas(64) double v[9][kLanes];  ///< column-major
  alignas(64) double s[3][kLanes];  ///< principal stretches; one is negative where inverted
  alignas(64) double limit_stress[3][kLanes];      ///< b'(s), Pa
  alignas(64) double limit_stiffness[3][kLanes];   ///< b''(s), Pa
  alignas(64) double memory_stress[3][3][kLanes];  ///< of the past, V^T H V, Pa
  alignas(64) float u[9][kLanes];                  ///< column-major
};

/// Symmetric stress in the material frame, xx yy zz xy xz yz, Pa.
struct ElementStress {
  alignas(64) double part[6][kLanes];
};

/// How a step sees viscoelastic material: its elastic energy times `factor`, plus the work done
/// against the stress remembered (H : S - I, S the stretch tensor).
struct ElementViscosity {
  double factor = 1.0;
  const ElementStress* memory = nullptr;  ///< null: remembers nothing
};

/// Contribution of one group to the gradient: force[a][k] of node a, component k.
struct ElementForces {
  alignas(64) double force[4][3][kLanes];
};

/// Of elements whose change of volume is averaged over a patch: V times the law's dilatation and
/// its gradient by the nodes, force[a][k] of node a, component k.
struct ElementDilatation {
  alignas(64) double value[kLanes];        ///< m^3
  alignas(64) double force[4][3][kLanes];  ///< m^2
};

/// Contribution of one group to the Hessian: the ten blocks (a, b), a <= b, in the order
/// 00 01 02 03 11 12 13 22 23 33, each column-major. Single precision, as the factor it goes into.
struct ElementHessians {
  alignas(64) float block[10][9][kLanes];
};

/// Second derivatives of one group by the motion of the rigid body that its tied nodes follow,
/// dx = dc + dtheta x r: rows of node a, columns of dc and of dtheta, each column-major.
struct ElementBodyHessians {
  alignas(64) float by_translation[4][9][kLanes];
  alignas(64) float by_rotation[4][9][kLanes];
};

/// Sums over groups, lane by lane, of the second derivatives by the body's motion alone.
struct BodyHessianSums {
  alignas(64) float translation[9][kLanes];           ///< dc, dc
  alignas(64) float translation_rotation[9][kLanes];  ///< dc, dtheta
  alignas(64) float rotation[9][kLanes];              ///< dtheta, dtheta
};

/// Element work, one set of functions per instruction set. The energy density is the constitutive
/// law's (constitutive_law.hpp) plus sum b(s_i) of the strain limits.
struct ElementKernels {
  /// positions: x y z of each node in turn, m. Reads decomposition->v as a start of the
  /// eigenvector iteration. Returns the energy of the group, J; forces are its gradient by
  /// the nodal positions, N. `dilatation` is filled unless null.
  double (*energy_gradient)(const ElementGroup& group, const StrainLimit& limit,
                            const ElementViscosity& viscosity, const double* positions,
                            ElementDecomposition* decomposition, ElementForces* forces,
                            ElementDilatation* dilatation);
  /// Second derivative at the decomposition last computed, N/m. `pressures`, one a lane, Pa, is
  /// what patches add to the principal stresses. `remembering`: a stress was remembered then.
  /// `projected` cuts negative eigenvalues (twist modes under compression) to zero.
  void (*hessian)(const ElementGroup& group, double factor,
                  const ElementDecomposition& decomposition, const double* pressures,
                  bool remembering, bool projected, ElementHessians* hessians);
  /// Elastic stress at the decomposition last computed; `pressures` as above but unscaled.
  void (*elastic_stress)(const ElementGroup& group, const ElementDecomposition& decomposition,
                         const double* pressures, ElementStress* stress);
  /// From a group's Hessian, what concerns the body; lever_arms: r of each node in turn, x y z, m.
  /// Adds to `sums`.
  void (*body_hessian)(const ElementGroup& group, const double* lever_arms,
                       const ElementHessians& hessians, ElementBodyHessians* rows,
                       BodyHessianSums* sums);
};

[[nodiscard]] const ElementKernels& element_kernels(InstructionSet set);

}  // namespace softfinger
