#include "softfinger/contact/contact_report.hpp"

#include <algorithm>
#include <limits>

#include "softfinger/contact/contact_area.hpp"
#include "softfinger/contact/feature_area.hpp"

namespace softfinger {
namespace {

/// A sample or a feature is in contact only above this normal force, N.
constexpr double kLeastNormalForce = 1e-6;

/// Areas of samples, and where the skin faces: the mean over their triangles, weighted so that
/// samples on a ball face away from its centre (Max, "Weights for computing vertex normals from
/// facet normals", Journal of Graphics Tools 4(2), 1999).
void report_skin(const SkinSurface& skin, std::span<const Vector3> positions, const Pose& X_FW,
                 ContactSet& set) {
  for (ContactSample& sample : set.samples) {
    sample.area = sample.taken = 0.0;
    sample.skin_normal_F.setZero();
  }
  for (const auto& triangle : skin.triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return positions[static_cast<std::size_t>(triangle[k])];
    };
    const Vector3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    const double third = normal.norm() / 6.0;
    std::array<double, 3> squares;  // of the sides opposite to the corners
    for (std::size_t k = 0; k < 3; ++k)
      squares[k] = (at((k + 2) % 3) - at((k + 1) % 3)).squaredNorm();
    const double product = squares[0] * squares[1] * squares[2];
    const double scale = product > 0.0 ? 1.0 / product : 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      ContactSample& sample = set.samples[static_cast<std::size_t>(triangle[k])];
      sample.area += third;
      sample.skin_normal_F += squares[k] * scale * normal;
    }
  }
  for (ContactSample& sample : set.samples) {
    sample.skin_normal_F = X_FW.rotation * sample.skin_normal_F.normalized();
  }
}

void report_samples(const SettledContact& contact, const Pose& X_FW, ContactSet& set) {
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    ContactSample& sample = set.samples[i];
    const ContactPotential::Nearest nearest = contact.potential.nearest(i);
    const ContactPotential::Forces forces = contact.potential.forces(i);
    sample.position_F = X_FW * contact.positions[i];
    sample.gap = nearest.gap;
    sample.object = nearest.obstacle;
    sample.on_soft = contact.potential.is_soft(nearest.obstacle);
    sample.normal_F = X_FW.rotation * nearest.normal;
    sample.normal_force_F = X_FW.rotation * forces.normal;
    sample.own_normal_force = forces.normal.norm();
    sample.tangential_force_F = X_FW.rotation * forces.tangential;
    sample.friction_limit = forces.friction_limit;
    sample.slides = forces.slides;
    sample.in_contact =
        sample.gap <= contact.tolerance && sample.own_normal_force > kLeastNormalForce;
    set.normal_force_sum += forces.normal_sum;
  }
}

/// A feature stands for its part of the triangle in the place of the corners, by its weights, but
/// for no more than a corner has of the triangle.
void take_area(const SkinSurface& skin, ContactFeature& feature, ContactSet& set) {
  std::array<Vector3, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) corners[c] = skin.position(feature.samples[c]);
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
void report_features(const SkinSurface& skin, const SettledContact& contact, const Pose& X_FW,
                     ContactSet& set) {
  set.feature_count = 0;
  for (std::size_t k = 0; k < contact.features.size(); ++k) {
    const FeaturePlace& place = contact.features[k];
    const std::size_t point = set.samples.size() + k;
    const ContactPotential::Forces forces = contact.potential.forces(point);
    ContactFeature feature;
    feature.samples = place.samples;
    feature.weights = place.weights;
    feature.position_F = X_FW * Vector3(contact.positions[point] - place.offset);
    feature.gap = contact.potential.nearest(point).gap - contact.feature_depth;
    feature.normal_force_F = X_FW.rotation * forces.normal;
    feature.tangential_force_F = X_FW.rotation * forces.tangential;
    feature.slides = forces.slides;
    feature.object = place.obstacle;
    set.normal_force_sum += forces.normal_sum;
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = place.weights[c];
      ContactSample& sample = set.samples[static_cast<std::size_t>(place.samples[c])];
      sample.normal_force_F += weight * feature.normal_force_F;
      sample.tangential_force_F += weight * feature.tangential_force_F;
      sample.friction_limit += weight * forces.friction_limit;
    }
    if (feature.normal_force_F.norm() <= kLeastNormalForce) continue;
    take_area(skin, feature, set);
    set.feature_places[set.feature_count++] = feature;
  }
}

void find_least_gap(const SettledContact& contact, const Pose& X_FW, ContactSet& set) {
  set.least_gap = std::numeric_limits<double>::infinity();
  set.nearest_normal_F = Vector3::UnitZ();
  for (const ContactSample& sample : set.samples) {
    if (sample.gap >= set.least_gap) continue;
    set.least_gap = sample.gap;
    set.nearest_normal_F = sample.normal_F;
  }
  for (std::size_t k = 0; k < contact.features.size(); ++k) {
    const ContactPotential::Nearest nearest = contact.potential.nearest(set.samples.size() + k);
    const double gap = nearest.gap - contact.feature_depth;
    if (gap >= set.least_gap) continue;
    set.least_gap = gap;
    set.nearest_normal_F = X_FW.rotation * nearest.normal;
  }
}

/// Of all the skin. Features count in the samples that they hand their forces to.
void sum_forces(ContactSet& set) {
  Vector3 normal_sum = Vector3::Zero();
  Vector3 tangential_sum = Vector3::Zero();
  double friction_limit = 0.0;
  for (ContactSample& sample : set.samples) {
    sample.normal_force = sample.normal_force_F.norm();
    normal_sum += sample.normal_force_F;
    tangential_sum += sample.tangential_force_F;
    friction_limit += sample.friction_limit;
  }
  set.tangential_force_F = tangential_sum;
  set.tangential_force = tangential_sum.norm();
  set.slip_ratio = friction_limit > 0.0 ? set.tangential_force / friction_limit : 0.0;
  set.normal_force = normal_sum.norm();
  set.mean_normal_F =
      set.normal_force > 0.0 ? Vector3(normal_sum / set.normal_force) : Vector3::Zero();
}

/// Where the force is borne, and the friction at the member that bears most of it: samples by what
/// they bear themselves, features by theirs.
void find_centre(const ContactPotential& potential, ContactSet& set) {
  set.centroid_F.setZero();
  double strongest = 0.0;
  double borne = 0.0;
  const auto press = [&](double force, const Vector3& position_F, int object) {
    borne += force;
    set.centroid_F += force * position_F;
    if (force <= std::max(strongest, kLeastNormalForce)) return;
    strongest = force;
    set.friction_coefficient = potential.friction_coefficient(static_cast<std::size_t>(object));
  };
  for (const ContactSample& sample : set.samples) {
    press(sample.own_normal_force, sample.position_F, sample.object);
  }
  for (const ContactFeature& feature : set.features()) {
    press(feature.normal_force_F.norm(), feature.position_F, feature.object);
  }
  if (borne > 0.0) set.centroid_F /= borne;
}

/// Members of C, and which part of them sticks. What features stand for counts with them, not with
/// the corners.
void count_members(const ContactPotential& potential, ContactSet& set) {
  set.contact_count = 0;
  double area = 0.0;
  double stuck_area = 0.0;
  for (const ContactSample& sample : set.samples) {
    area += sample.touched() * sample.area;
    if (!sample.in_contact) continue;
    ++set.contact_count;
    if (sample.friction_limit > 0.0 && !sample.slides) {
      stuck_area += (1.0 - sample.taken) * sample.area;
    }
  }
  for (const ContactFeature& feature : set.features()) {
    ++set.contact_count;
    const bool rubs =
        potential.friction_coefficient(static_cast<std::size_t>(feature.object)) > 0.0;
    if (rubs && !feature.slides) stuck_area += feature.area;
  }
  set.stuck_fraction = area > 0.0 ? std::min(1.0, stuck_area / area) : 0.0;
}

}  // namespace

ContactSet make_contact_set(const SkinSurface& skin, double friction_coefficient) {
  ContactSet set;
  set.friction_coefficient = friction_coefficient;
  set.samples.resize(skin.sample_nodes.size());
  set.triangles.resize(skin.triangles.size());
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    set.samples[i].rest_area = skin.sample_areas[i];
    set.samples[i].position_F = skin.position(static_cast<int>(i));
  }
  return set;
}

void report_contact(const SkinSurface& skin, const SettledContact& contact, ContactSet& set) {
  const Pose X_FW = contact.X_WF.inverse();
  set.normal_force_sum = 0.0;
  report_skin(skin, contact.positions, X_FW, set);
  report_samples(contact, X_FW, set);
  report_features(skin, contact, X_FW, set);
  find_least_gap(contact, X_FW, set);
  sum_forces(set);
  find_centre(contact.potential, set);
  count_members(contact.potential, set);
  report_area(skin, contact, set);
}

}  // namespace softfinger
