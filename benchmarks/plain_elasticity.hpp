#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/fem/double_arithmetic.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// The elastic energy of a finger's tissue as one would write it first, element by element with
/// Eigen's decompositions and in double precision throughout. The law is written out here a second
/// time, on purpose: that both steps agree says something of the law's file only as long as this
/// does not include it. Shares nothing with softfinger/fem but the strain limit's formula.
class PlainElasticity {
 public:
  using ElementHessian = Eigen::Matrix<double, 12, 12>;

  /// Throws InputError for tissue that relaxes or averages its change of volume.
  explicit PlainElasticity(const FingerModel& model);

  /// Lumped mass of each node, kg.
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  [[nodiscard]] std::size_t elements() const { return elements_.size(); }
  [[nodiscard]] const std::array<int, 4>& nodes(std::size_t e) const { return elements_[e].nodes; }

  /// Returns the energy at `positions`, J, and adds its gradient to `gradient`, N.
  double energy_gradient(std::span<const Vector3> positions, std::span<Vector3> gradient) const;
  /// Second derivative of one element's energy by its four nodes, N/m, made positive semidefinite.
  [[nodiscard]] ElementHessian hessian(std::size_t e, std::span<const Vector3> positions) const;

 private:
  struct Element {
    std::array<int, 4> nodes;
    Eigen::Matrix<double, 3, 4> shape_gradients;  ///< 1/m
    double volume, mu, lambda;
  };
  /// F = U S V^T with det U = det V = 1, and derivatives of the energy density by the stretches.
  struct Deformation {
    Matrix3 U, V;
    Vector3 stretches, stresses, curvatures;
    double energy_density = 0.0;
  };
  [[nodiscard]] Deformation deform(const Element& element,
                                   std::span<const Vector3> positions) const;

  std::vector<Element> elements_;
  std::vector<double> masses_;
  StrainLimit limit_;
};

}  // namespace softfinger
