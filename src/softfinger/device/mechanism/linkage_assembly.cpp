#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "softfinger/device/mechanism/closed_linkage.hpp"

namespace softfinger {
namespace {

using Decomposition = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

constexpr int kMostSteps = 200;
constexpr double kLongestStep = 0.3;   // rad, or of the linkage's length
constexpr double kRounding = 1e-15;    // of the linkage's length
constexpr double kIndependent = 1e-6;  // least pivot of independent equations, relative

/// Equations by the coordinates, angles in units of the linkage's length.
Eigen::MatrixXd scaled_derivatives(const Linkage& linkage, const LinkagePlacement& placement) {
  Eigen::MatrixXd rows =
      Eigen::MatrixXd::Zero(linkage.equation_count(), linkage.coordinate_count());
  for (int e = 0; e < linkage.equation_count(); ++e) linkage.gradient(e, placement, rows, e);
  for (int j = 0; j < linkage.coordinate_count(); ++j) {
    if (linkage.is_angle(j)) rows.col(j) /= linkage.length();
  }
  return rows;
}

}  // namespace

LinkageAssembly assemble(const Linkage& linkage, const LinkageCoordinates& guess) {
  const int equations = linkage.equation_count();
  const int coordinates = linkage.coordinate_count();
  LinkageAssembly assembly;
  assembly.x = guess;
  assembly.degrees_of_freedom = coordinates;
  if (equations == 0) return assembly;
  LinkagePlacement placement;
  Eigen::VectorXd residual(equations);
  Eigen::MatrixXd rows;
  for (int iteration = 0; iteration < kMostSteps; ++iteration) {
    linkage.place(assembly.x, placement);
    for (int e = 0; e < equations; ++e) residual[e] = linkage.residual(e, placement);
    rows = scaled_derivatives(linkage, placement);
    assembly.worst_residual = residual.cwiseAbs().maxCoeff(&assembly.worst_equation);
    if (assembly.worst_residual < kRounding * linkage.length()) break;
    Decomposition decomposition;
    decomposition.setThreshold(kIndependent);
    decomposition.compute(rows);
    Eigen::VectorXd step = -decomposition.solve(residual) / linkage.length();
    if (!step.allFinite()) break;
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest < kRounding) break;
    if (longest > kLongestStep) step *= kLongestStep / longest;
    for (int j = 0; j < coordinates; ++j) {
      if (!linkage.is_angle(j)) step[j] *= linkage.length();
    }
    linkage.move(assembly.x, step);
  }
  if (assembly.worst_residual < 1e-9 * linkage.length()) assembly.worst_residual = 0.0;

  // Columns are equations here: the pivots tell which of them are independent.
  Decomposition pivoted;
  pivoted.setThreshold(kIndependent);
  pivoted.compute(rows.transpose());
  const auto rank = static_cast<int>(pivoted.rank());
  assembly.degrees_of_freedom = coordinates - rank;
  for (int k = 0; k < rank; ++k) {
    assembly.independent_equations.push_back(pivoted.colsPermutation().indices()[k]);
  }
  std::sort(assembly.independent_equations.begin(), assembly.independent_equations.end());
  return assembly;
}

}  // namespace softfinger
