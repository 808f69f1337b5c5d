#include "softfinger/finger/contact_report.hpp"

#include <algorithm>

#include "softfinger/finger/feature_area.hpp"

namespace softfinger {
namespace {

/// A sample or a feature is in contact only above this normal force, N.
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

/// A feature stands for its part of the triangle in the place of the corners, by its weights, but
/// for no more than a corner has of the triangle.
void take_area(const FingerModel& model, ContactFeature& feature, ContactSet& set) {
  std::array<Vector3, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) {
    const int node = model.sample_nodes[static_cast<std::size_t>(feature.samples[c])];
    corners[c] = model.mesh.nodes[static_cast<std::size_t>(node)];
  }
  const double triangle = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  const double part = part_nearer_than_corners(corners, feature.weights);
  for (std::size_t c = 0; c < 3; ++c) {
    ContactSample& sample = set.samples[static_cast<std::size_t>(feature.samples[c])];
    const double share = std::min(feature.weights[c] * part, 1.0 / 3.0) * triangle;
    const double of_sample = share / sample.rest_area;
    feature.rest_area += share;
    feature.area += of_sample * sample.area;
    sample.taken = std::min(1.0, sample.taken + of_sample);
  }
}

/// What feature points carry, to the samples at the corners of their triangles; those in contact to
/// the features of `set`.
void add_features(const FingerModel& model, const FingerPotential& potential, const Pose& X_FW,
                  ContactSet& set) {
  set.feature_count = 0;
  const std::size_t samples = set.samples.size();
  const std::span<const FeaturePoints::Point> points = potential.features().points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const FeaturePoints::Point& point = points[k];
    const ContactPotential::Forces forces = potential.contact().forces(samples + k);
    ContactFeature feature;
    feature.samples = point.samples;
    feature.weights = point.weights;
    feature.position_F = X_FW * Vector3(potential.contact_positions()[samples + k] - point.offset);
    feature.gap = potential.contact().nearest(samples + k).gap - FeaturePoints::kDepth;
    feature.normal_force_F = X_FW.rotation * forces.normal;
    feature.tangential_force_F = X_FW.rotation * forces.tangential;
    feature.slides = forces.slides;
    feature.object = point.obstacle;
    set.normal_force_sum += forces.normal_sum;
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = point.weights[c];
      ContactSample& sample = set.samples[static_cast<std::size_t>(point.samples[c])];
      sample.normal_force_F += weight * feature.normal_force_F;
      sample.tangential_force_F += weight * feature.tangential_force_F;
      sample.friction_limit += weight * forces.friction_limit;
    }
    if (feature.normal_force_F.norm() <= kLeastNormalForce) continue;
    take_area(model, feature, set);
    set.feature_places[set.feature_count++] = feature;
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
  for (ContactSample& sample : set.samples) sample.area = sample.taken = 0.0;
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
    sample.own_normal_force = forces.normal.norm();
    sample.tangential_force_F = X_FW.rotation * forces.tangential;
    sample.friction_limit = forces.friction_limit;
    sample.slides = forces.slides;
    set.normal_force_sum += forces.normal_sum;
    see(nearest.gap, nearest.normal);
  }
  add_features(model, potential, X_FW, set);
  for (std::size_t k = 0; k < potential.features().points().size(); ++k) {
    const ContactPotential::Nearest nearest = contact.nearest(set.samples.size() + k);
    see(nearest.gap - FeaturePoints::kDepth, nearest.normal);
  }
  const auto press = [&](double force, const Vector3& position_F, int object) {
    borne += force;
    set.centroid_F += force * position_F;
    if (force <= std::max(strongest, kLeastNormalForce)) return;
    strongest = force;
    set.friction_coefficient = contact.friction_coefficient(static_cast<std::size_t>(object));
  };
  for (ContactSample& sample : set.samples) {
    sample.normal_force = sample.normal_force_F.norm();
    sample.in_contact =
        sample.gap <= model.contact_tolerance && sample.own_normal_force > kLeastNormalForce;
    tangential_sum += sample.tangential_force_F;
    friction_limit += sample.friction_limit;
    normal_sum += sample.normal_force_F;
    press(sample.own_normal_force, sample.position_F, sample.object);
    set.contact_area += sample.touched() * sample.area;
    if (!sample.in_contact) continue;
    ++set.contact_count;
    if (sample.friction_limit > 0.0 && !sample.slides) {
      stuck_area += (1.0 - sample.taken) * sample.area;
    }
  }
  for (const ContactFeature& feature : set.features()) {
    press(feature.normal_force_F.norm(), feature.position_F, feature.object);
    ++set.contact_count;
    const bool rubs = contact.friction_coefficient(static_cast<std::size_t>(feature.object)) > 0.0;
    if (rubs && !feature.slides) stuck_area += feature.area;
  }
  set.tangential_force = tangential_sum.norm();
  set.slip_ratio = friction_limit > 0.0 ? set.tangential_force / friction_limit : 0.0;
  set.stuck_fraction = set.contact_area > 0.0 ? std::min(1.0, stuck_area / set.contact_area) : 0.0;
  if (borne > 0.0) set.centroid_F /= borne;
  set.normal_force = normal_sum.norm();
  set.mean_normal_F =
      set.normal_force > 0.0 ? Vector3(normal_sum / set.normal_force) : Vector3::Zero();
}

}  // namespace softfinger
