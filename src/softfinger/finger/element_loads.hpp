#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "softfinger/fem/double_arithmetic.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Components xx, yy, zz, yz, zx, xy of a symmetric stress, Pa.
using Stress = std::array<double, 6>;

/// What every soft element of a finger bears by the constitutive law and the strain limits, of the
/// instantaneous moduli. Element by element from principal
/// axes: for judging states, not for stepping. Allocates only in the constructor;
/// one thread at a time.
class ElementLoads {
 public:
  explicit ElementLoads(std::shared_ptr<const FingerModel> model);

  /// Soft elements, in the order of the mesh; those whose nodes are all rigid are left out.
  [[nodiscard]] std::size_t size() const { return elements_.size(); }
  /// Nodes of one of them.
  [[nodiscard]] const std::array<int, 4>& nodes(std::size_t e) const { return elements_[e].nodes; }
  /// Rest volume of each, m^3.
  [[nodiscard]] std::span<const double> volumes() const { return volumes_; }
  /// Strain energy density of each with the nodes at `positions` (all nodes, m, any frame), J/m^3.
  void energy_densities(std::span<const Vector3> positions, std::span<double> densities);
  /// Cauchy stress of each, in the frame of the positions.
  void stresses(std::span<const Vector3> positions, std::span<Stress> stresses);

 private:
  using Law = ConstitutiveLaw<DoubleArithmetic>;
  struct Element {
    std::array<int, 4> nodes;
    double lambda, mu;  ///< Pa
    int patch;          ///< -1: keeps its own volume
    Matrix3 rest_inverse;
  };
  /// F = axes diag(stretches) V^T; one stretch is negative where the element is inside out.
  struct Deformation {
    Matrix3 axes;
    double stretches[3];
    double dilatation;  ///< the patch's mean where there is one
  };

  void deform(std::span<const Vector3> positions);
  /// Of element e as deformed.
  [[nodiscard]] Law law(std::size_t e) const;

  std::shared_ptr<const FingerModel> model_;
  std::vector<Element> elements_;
  std::vector<double> volumes_;
  std::vector<double> patch_volumes_;
  std::vector<Deformation> deformations_;
  std::vector<double> patch_dilatations_;
};

}  // namespace softfinger
