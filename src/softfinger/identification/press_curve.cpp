#include "softfinger/identification/press_curve.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

constexpr double kSpacing = 0.05e-3;  // m; the error of interpolation is below 0.1 %
constexpr int kFewestRows = 8;
constexpr double kLeastShare = 0.02;  // of the greatest force: below, single samples make the area

}  // namespace

FingerModel with_constants(const FingerModel& model, const FingerConstants& constants) {
  FingerModel result = model;
  for (FingerModel::Material& material : result.materials) {
    material.youngs_modulus *= constants.youngs_modulus_factor;
  }
  if (result.strain_limits.stiffness > 0.0) {
    result.strain_limits.min = constants.min;
    result.strain_limits.max = constants.max;
  }
  return result;
}

PressCurve::PressCurve(double spacing, std::vector<double> forces, const std::vector<double>& areas)
    : spacing_(spacing), forces_(std::move(forces)), roots_{0.0} {
  for (const double force : forces_) roots_.push_back(std::cbrt(force * force));
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    if (areas[i] > 0.0 && forces_[i] > kLeastShare * forces_.back()) {
      points.emplace_back(std::log(forces_[i]), std::log(areas[i]));
    }
  }
  if (points.size() < 3) return;
  Eigen::MatrixX3d basis(points.size(), 3);
  Eigen::VectorXd logs(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    basis.row(row) << 1.0, points[i].x(), points[i].x() * points[i].x();
    logs[row] = points[i].y();
  }
  Eigen::Map<Eigen::Vector3d>(static_cast<double*>(area_log_)) =
      basis.colPivHouseholderQr().solve(logs);
}

double PressCurve::force(double depth) const {
  const auto last = roots_.size() - 1;
  const double s = std::clamp(depth / spacing_, 0.0, static_cast<double>(last));
  const std::size_t k = std::min(static_cast<std::size_t>(s), last - 1);
  const auto slope = [&](std::size_t i) {
    if (i == 0) return (-3.0 * roots_[0] + 4.0 * roots_[1] - roots_[2]) / 2.0;
    if (i == last) return (3.0 * roots_[i] - 4.0 * roots_[i - 1] + roots_[i - 2]) / 2.0;
    return (roots_[i + 1] - roots_[i - 1]) / 2.0;
  };
  const double t = s - static_cast<double>(k);
  const double u = 1.0 - t;
  const double root = u * u * (1.0 + 2.0 * t) * roots_[k] +
                      t * t * (3.0 - 2.0 * t) * roots_[k + 1] +
                      t * u * (u * slope(k) - t * slope(k + 1));
  return std::pow(std::max(root, 0.0), 1.5);
}

double PressCurve::area(double force) const {
  const double x = std::log(force);
  return std::exp(area_log_[0] + x * (area_log_[1] + x * area_log_[2]));
}

std::optional<PressCurve> simulate_press(const FingerModel& model, double depth, double pitch) {
  IndentationOptions options;
  options.depth = depth;
  options.rows = std::max(kFewestRows, static_cast<int>(std::ceil(depth / kSpacing - 1e-9)));
  options.pitch = pitch;
  std::vector<double> forces, areas;
  bool converged = true;
  indent(model, Indenter::plane(), options, [&](const IndentationState& state) {
    converged = converged && state.row.converged && state.row.normal_force > 0.0;
    forces.push_back(state.row.normal_force);
    areas.push_back(state.row.contact_area);
  });
  if (!converged) return std::nullopt;
  return PressCurve(depth / options.rows, std::move(forces), areas);
}

}  // namespace softfinger
