#include "softfinger/twin/rendering_measures.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kLeastForce = 0.05;  // N; errors of smaller forces are measured against it
constexpr double kBorne = 0.01;  // N; skin that bears more is touched, whatever its contact set

double pressure(const ContactSample& sample) {
  return sample.area > 0.0 ? sample.normal_force / sample.area : 0.0;
}

/// sqrt(sum w (t - v)^2 / sum w v^2); undefined where v is zero throughout.
class RelativeError {
 public:
  void add(double weight, double reference, double value) {
    difference_ += weight * (value - reference) * (value - reference);
    reference_ += weight * reference * reference;
  }
  [[nodiscard]] double value() const {
    return reference_ > 0.0 ? std::sqrt(difference_ / reference_) : RenderingMeasures::kUndefined;
  }

 private:
  double difference_ = 0.0, reference_ = 0.0;
};

/// Whether a side touches. Friction alone may bear: skin that is drawn off still holds on.
bool touches(const ContactSet& side) {
  return side.contact_count > 0 || side.normal_force > kBorne || side.normal_force_sum > kBorne ||
         side.tangential_force > kBorne;
}

/// value / of; undefined where `of` is zero.
double ratio(double value, double of) {
  return of > 0.0 ? value / of : RenderingMeasures::kUndefined;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

RenderingMeasures compare(const TouchedSkin& virtual_side, const TouchedSkin& twin) {
  const ContactSet& v = virtual_side.contact;
  const ContactSet& t = twin.contact;
  RenderingMeasures result;
  const bool v_touches = touches(v);
  const bool t_touches = touches(t);
  if (!v_touches && !t_touches) return result;
  double common = 0.0;
  double either = 0.0;
  RelativeError pressures;
  for (std::size_t i = 0; i < v.samples.size(); ++i) {
    const ContactSample& a = v.samples[i];
    const ContactSample& b = t.samples[i];
    common += std::min(a.touched(), b.touched()) * a.rest_area;
    either += std::max(a.touched(), b.touched()) * a.rest_area;
    pressures.add(a.rest_area, pressure(a), pressure(b));
  }
  if (!v_touches || !t_touches) {
    result.kind = v_touches ? FrameKind::kMissed : FrameKind::kFalse;
    result.iou = 0.0;
    return result;
  }
  result.iou = ratio(common, either);
  result.kind = FrameKind::kBoth;
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
  result.pressure_error = pressures.value();
  RelativeError energies;
  RelativeError stresses;
  for (std::size_t e = 0; e < virtual_side.energy_densities.size(); ++e) {
    energies.add(virtual_side.volumes[e], virtual_side.energy_densities[e],
                 twin.energy_densities[e]);
    for (std::size_t c = 0; c < 6; ++c) {
      // Shear stands twice in the tensor.
      const double weight = (c < 3 ? 1.0 : 2.0) * virtual_side.volumes[e];
      stresses.add(weight, virtual_side.stresses[e][c], twin.stresses[e][c]);
    }
  }
  result.stress_error = stresses.value();
  result.strain_energy_density_error = energies.value();
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
