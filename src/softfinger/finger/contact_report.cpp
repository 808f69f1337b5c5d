#include "softfinger/finger/contact_report.hpp"

namespace softfinger {
namespace {

/// A sample is in contact only above this normal force, N.
constexpr double kLeastNormalForce = 1e-6;

void add_deformed_areas(const FingerModel& model, std::span<const Vector3> positions,
                        ContactSet& set) {
  for (const auto& triangle : model.skin_triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return positions[static_cast<std::size_t>(triangle[k])];
    };
    const double third = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6.0;
    for (int sample : triangle) set.samples[static_cast<std::size_t>(sample)].area += third;
  }
}

}  // namespace

ContactSet make_contact_set(const FingerModel& model) {
  ContactSet set;
  set.samples.resize(model.sample_nodes.size());
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    set.samples[i].rest_area = model.sample_rest_areas[i];
    set.samples[i].position_F = model.mesh.nodes[static_cast<std::size_t>(model.sample_nodes[i])];
  }
  return set;
}

void report_contact(const FingerModel& model, const FingerPotential& potential, ContactSet& set) {
  const Pose X_FW = potential.bone_pose().inverse();
  set.contact_count = 0;
  set.contact_area = 0.0;
  set.normal_force = 0.0;
  set.centroid_F.setZero();
  set.least_gap = std::numeric_limits<double>::infinity();
  set.nearest_normal_F = Vector3::UnitZ();
  Vector3 normal_sum = Vector3::Zero();
  Vector3 tangential_sum = Vector3::Zero();
  double friction_limit = 0.0;
  double stuck_area = 0.0;
  for (ContactSample& sample : set.samples) sample.area = 0.0;
  add_deformed_areas(model, potential.sample_positions(), set);
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    ContactSample& sample = set.samples[i];
    potential.contact().report(i, sample);
    sample.position_F = X_FW * potential.sample_positions()[i];
    sample.normal_F = X_FW.rotation * sample.normal_F;
    sample.tangential_force_F = X_FW.rotation * sample.tangential_force_F;
    sample.in_contact =
        sample.gap <= model.contact_tolerance && sample.normal_force > kLeastNormalForce;
    if (sample.gap < set.least_gap) {
      set.least_gap = sample.gap;
      set.nearest_normal_F = sample.normal_F;
    }
    tangential_sum += sample.tangential_force_F;
    if (!sample.in_contact) continue;
    ++set.contact_count;
    set.contact_area += sample.area;
    friction_limit += sample.friction_limit;
    if (sample.friction_limit > 0.0 && !sample.slides) stuck_area += sample.area;
    set.normal_force += sample.normal_force;
    set.centroid_F += sample.normal_force * sample.position_F;
    normal_sum += sample.normal_force * sample.normal_F;
  }
  set.tangential_force = tangential_sum.norm();
  set.slip_ratio = friction_limit > 0.0 ? set.tangential_force / friction_limit : 0.0;
  set.stuck_fraction = set.contact_area > 0.0 ? stuck_area / set.contact_area : 0.0;
  if (set.normal_force > 0.0) set.centroid_F /= set.normal_force;
  const double length = normal_sum.norm();
  set.mean_normal_F = length > 0.0 ? Vector3(normal_sum / length) : Vector3::Zero();
}

}  // namespace softfinger
