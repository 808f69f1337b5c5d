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

/// What feature points carry, to the samples at the corners of their triangles.
void add_features(const FingerPotential& potential, const Pose& X_FW, ContactSet& set) {
  const std::size_t samples = set.samples.size();
  const std::span<const FeaturePoints::Point> points = potential.features().points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ContactPotential::Forces forces = potential.contact().forces(samples + k);
    set.normal_force_sum += forces.normal_sum;
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = points[k].weights[c];
      ContactSample& sample = set.samples[static_cast<std::size_t>(points[k].samples[c])];
      sample.normal_force_F += weight * X_FW.rotation * forces.normal;
      sample.tangential_force_F += weight * X_FW.rotation * forces.tangential;
      sample.friction_limit += weight * forces.friction_limit;
    }
  }
}

}  // namespace

ContactSet make_contact_set(const FingerModel& model) {
  ContactSet set;
  set.friction_coefficient = model.friction_coefficient;
  set.samples.resize(model.sample_nodes.size());
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    set.samples[i].rest_area = model.sample_rest_areas[i];
    set.samples[i].position_F = model.mesh.nodes[static_cast<std::size_t>(model.sample_nodes[i])];
  }
  return set;
}

void report_contact(const FingerModel& model, const FingerPotential& potential, ContactSet& set) {
  const Pose X_FW = potential.bone_pose().inverse();
  const ContactPotential& contact = potential.contact();
  set.contact_count = 0;
  set.contact_area = 0.0;
  set.normal_force_sum = 0.0;
  set.centroid_F.setZero();
  set.least_gap = std::numeric_limits<double>::infinity();
  set.nearest_normal_F = Vector3::UnitZ();
  Vector3 normal_sum = Vector3::Zero();
  Vector3 tangential_sum = Vector3::Zero();
  double friction_limit = 0.0;
  double stuck_area = 0.0;
  double strongest = 0.0;
  double borne = 0.0;
  const auto see = [&](double gap, const Vector3& normal_W) {
    if (gap >= set.least_gap) return;
    set.least_gap = gap;
    set.nearest_normal_F = X_FW.rotation * normal_W;
  };
  for (ContactSample& sample : set.samples) sample.area = 0.0;
  add_deformed_areas(model, potential.contact_positions(), set);
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    ContactSample& sample = set.samples[i];
    const ContactPotential::Nearest nearest = contact.nearest(i);
    const ContactPotential::Forces forces = contact.forces(i);
    sample.position_F = X_FW * potential.contact_positions()[i];
    sample.gap = nearest.gap;
    sample.object = nearest.obstacle;
    sample.normal_F = X_FW.rotation * nearest.normal;
    sample.normal_force_F = X_FW.rotation * forces.normal;
    sample.tangential_force_F = X_FW.rotation * forces.tangential;
    sample.friction_limit = forces.friction_limit;
    sample.slides = forces.slides;
    set.normal_force_sum += forces.normal_sum;
    see(nearest.gap, nearest.normal);
  }
  add_features(potential, X_FW, set);
  for (std::size_t k = 0; k < potential.features().points().size(); ++k) {
    const ContactPotential::Nearest nearest = contact.nearest(set.samples.size() + k);
    see(nearest.gap - FeaturePoints::kDepth, nearest.normal);
  }
  for (ContactSample& sample : set.samples) {
    sample.normal_force = sample.normal_force_F.norm();
    sample.in_contact =
        sample.gap <= model.contact_tolerance && sample.normal_force > kLeastNormalForce;
    tangential_sum += sample.tangential_force_F;
    friction_limit += sample.friction_limit;
    borne += sample.normal_force;
    set.centroid_F += sample.normal_force * sample.position_F;
    normal_sum += sample.normal_force_F;
    if (!sample.in_contact) continue;
    ++set.contact_count;
    set.contact_area += sample.area;
    if (sample.friction_limit > 0.0 && !sample.slides) stuck_area += sample.area;
    if (sample.normal_force > strongest) {
      strongest = sample.normal_force;
      set.friction_coefficient =
          contact.friction_coefficient(static_cast<std::size_t>(sample.object));
    }
  }
  set.tangential_force = tangential_sum.norm();
  set.slip_ratio = friction_limit > 0.0 ? set.tangential_force / friction_limit : 0.0;
  set.stuck_fraction = set.contact_area > 0.0 ? stuck_area / set.contact_area : 0.0;
  if (borne > 0.0) set.centroid_F /= borne;
  set.normal_force = normal_sum.norm();
  set.mean_normal_F =
      set.normal_force > 0.0 ? Vector3(normal_sum / set.normal_force) : Vector3::Zero();
}

}  // namespace softfinger
