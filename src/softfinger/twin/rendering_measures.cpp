#include "softfinger/twin/rendering_measures.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kLeastForce = 0.05;  // N; errors of smaller forces are measured against it
constexpr double kBorne = 0.01;  // N; skin that bears more is touched, whatever its contact set

/// sqrt(sum w (t - v)^2 / sum w v^2); undefined where v is zero throughout.
class RelativeError {
 public:
  void add(double factor, std::span<const double> weights, std::span<const double> reference,
           std::span<const double> values) {
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double off = values[k] - reference[k];
      difference_ += factor * weights[k] * off * off;
      reference_ += factor * weights[k] * reference[k] * reference[k];
    }
  }
  [[nodiscard]] double value() const {
    return reference_ > 0.0 ? std::sqrt(difference_ / reference_) : RenderingMeasures::kUndefined;
  }

 private:
  double difference_ = 0.0, reference_ = 0.0;
};

/// value / of; undefined where `of` is zero.
double ratio(double value, double of) {
  return of > 0.0 ? value / of : RenderingMeasures::kUndefined;
}

/// Area of both over area of either.
double overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b,
               std::span<const double> areas) {
  double common = 0.0;
  double either = 0.0;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    if (a[k] != 0 && b[k] != 0) common += areas[k];
    if (a[k] != 0 || b[k] != 0) either += areas[k];
  }
  return ratio(common, either);
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

bool touches(const ContactSums& side) {
  return side.contact_count > 0 || side.normal_force > kBorne || side.normal_force_sum > kBorne ||
         side.tangential_force > kBorne;
}

RenderingMeasures compare(const LaidSide& virtual_side, const LaidSide& twin,
                          const PlaceWeights& weights) {
  const ContactSums& v = virtual_side.sums;
  const ContactSums& t = twin.sums;
  RenderingMeasures result;
  const bool v_touches = touches(v);
  const bool t_touches = touches(t);
  if (!v_touches && !t_touches) return result;
  if (!v_touches || !t_touches) {
    result.kind = v_touches ? FrameKind::kMissed : FrameKind::kFalse;
    result.iou = 0.0;
    return result;
  }
  result.kind = FrameKind::kBoth;
  result.iou = overlap(virtual_side.touched, twin.touched, weights.skin);
  if (v.contact_count > 0 && t.contact_count > 0) {
    result.centroid_shift = (t.centroid_F - v.centroid_F).norm();
    result.normal_angle = angle_between(v.mean_normal_F, t.mean_normal_F);
  }
  result.normal_force_bias =
      (t.normal_force - v.normal_force) / std::max(v.normal_force, kLeastForce);
  result.normal_force_error = std::abs(result.normal_force_bias);
  result.tangential_force_error =
      (t.tangential_force_F - v.tangential_force_F).norm() / std::max(v.normal_force, kLeastForce);
  result.slip_ratio_error = std::abs(t.slip_ratio - v.slip_ratio);
  result.contact_area_error = ratio(std::abs(t.contact_area - v.contact_area), v.contact_area);
  RelativeError pressures;
  pressures.add(1.0, weights.pressures, virtual_side.pressures, twin.pressures);
  result.pressure_error = pressures.value();
  RelativeError energies;
  energies.add(1.0, weights.tissue, virtual_side.energy_densities, twin.energy_densities);
  result.strain_energy_density_error = energies.value();
  RelativeError stresses;
  const std::size_t cells = weights.tissue.size();
  for (std::size_t c = 0; c < 6; ++c) {
    // Shear stands twice in the tensor.
    stresses.add(c < 3 ? 1.0 : 2.0, weights.tissue, virtual_side.stresses.subspan(c * cells, cells),
                 twin.stresses.subspan(c * cells, cells));
  }
  result.stress_error = stresses.value();
  return result;
}

const std::array<MeasureName, kMeasures>& measure_names() {
  using M = RenderingMeasures;
  static const std::array<MeasureName, kMeasures> kNames{{
      {"iou", 1.0, &M::iou},
      {"centroid_shift_mm", mm, &M::centroid_shift},
      {"normal_angle_deg", deg, &M::normal_angle},
      {"normal_force_error", 1.0, &M::normal_force_error},
      {"normal_force_bias", 1.0, &M::normal_force_bias},
      {"tangential_force_error", 1.0, &M::tangential_force_error},
      {"slip_ratio_error", 1.0, &M::slip_ratio_error},
      {"contact_area_error", 1.0, &M::contact_area_error},
      {"pressure_error", 1.0, &M::pressure_error},
      {"strain_energy_density_error", 1.0, &M::strain_energy_density_error},
      {"stress_error", 1.0, &M::stress_error},
  }};
  return kNames;
}

void MeasureMeans::add(const RenderingMeasures& measures) {
  ++frames_[static_cast<std::size_t>(measures.kind)];
  for (std::size_t k = 0; k < kMeasures; ++k) {
    const double value = measures.*measure_names()[k].member;
    if (std::isnan(value)) continue;
    sums_[k] += value;
    ++counts_[k];
  }
}

RenderingMeasures MeasureMeans::mean() const {
  RenderingMeasures mean;
  for (std::size_t k = 0; k < kMeasures; ++k) {
    if (counts_[k] > 0) mean.*measure_names()[k].member = sums_[k] / counts_[k];
  }
  return mean;
}

}  // namespace softfinger
