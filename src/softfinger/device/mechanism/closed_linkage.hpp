#pragma once

#include <span>
#include <vector>

#include "softfinger/device/mechanism/linkage.hpp"
#include "softfinger/numerics/small_sparse_lu.hpp"

namespace softfinger {

/// Most degrees of freedom of a linkage with loops.
inline constexpr int kMaxLinkageInputs = 12;

/// A linkage's loops share few coordinates: most of its derivatives are zero.
using LinkageLu = SmallSparseLu<kMaxLinkageCoordinates>;
using LinkageMatrix = LinkageLu::Matrix;
using LinkageInputs =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLinkageInputs, 1>;
using LinkageSensitivity = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                         kMaxLinkageCoordinates, kMaxLinkageInputs>;

/// A linkage whose loops are closed, at given values of as many readings as it has freedom.
struct LinkageSolution {
  LinkageCoordinates x;
  LinkageInputs values;  ///< of the readings
  LinkagePlacement placement;
  LinkageSensitivity by_value;  ///< rates of x by the values
  LinkageLu lu;                 ///< of the derivatives of equations and readings by x
  double determinant = 0.0;     ///< of these derivatives
};

/// A linkage with those of its loop equations that are independent, as many as coordinates less the
/// degrees of freedom. Values of readings determine its coordinates: Newton's method from a known
/// solution, in steps that keep to its branch. Immutable; nothing allocates or throws.
class ClosedLinkage {
 public:
  ClosedLinkage(Linkage linkage, std::vector<int> independent_equations);

  [[nodiscard]] const Linkage& linkage() const { return linkage_; }
  [[nodiscard]] int degrees_of_freedom() const {
    return linkage_.coordinate_count() - static_cast<int>(independent_.size());
  }

  /// Derivatives by the coordinates: the independent equations, then the readings.
  void derivatives(std::span<const LinkageReading> readings, const LinkagePlacement& placement,
                   LinkageMatrix& matrix) const;
  /// How they change with the velocity; rows whose weight is 0 stay 0.
  void derivative_rates(std::span<const LinkageReading> readings, const LinkagePlacement& placement,
                        const LinkageVelocity& velocity, const LinkageCoordinates& weights,
                        LinkageMatrix& matrix) const;

  /// Fills in all of the solution from its x, which is on it; false where it is singular.
  [[nodiscard]] bool complete(std::span<const LinkageReading> readings,
                              LinkageSolution& solution) const;
  /// Newton from solution.x to where the readings have solution.values. False, and the solution is
  /// spoilt, unless it converges at once, as it does from nearby.
  [[nodiscard]] bool close(std::span<const LinkageReading> readings,
                           LinkageSolution& solution) const;
  /// Takes the solution along the straight line of values to `values`, never through a singularity.
  /// Of the solution's start all but its factors is used. False where that does not lead there; the
  /// solution is then the last one on the way.
  [[nodiscard]] bool follow(std::span<const LinkageReading> readings, const LinkageInputs& values,
                            LinkageSolution& solution) const;

 private:
  void fill_sensitivity(int readings, LinkageSolution& solution) const;

  Linkage linkage_;
  std::vector<int> independent_;
  std::vector<int> dependent_;
};

/// What closing the loops of a linkage from a first guess found.
struct LinkageAssembly {
  LinkageCoordinates x;         ///< nearest to the guess
  double worst_residual = 0.0;  ///< m; not 0: the loops do not close
  int worst_equation = -1;
  int degrees_of_freedom = 0;
  std::vector<int> independent_equations;
};

/// Closes the loops by least-norm Gauss-Newton steps from `guess`. Allocates.
[[nodiscard]] LinkageAssembly assemble(const Linkage& linkage, const LinkageCoordinates& guess);

}  // namespace softfinger
