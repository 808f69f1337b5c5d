#include "softfinger/finger/finger_contact.hpp"

#include <algorithm>
#include <array>

#include "softfinger/contact/contact_report.hpp"

namespace softfinger {
namespace {

SkinSurface skin_of(const FingerModel& model) {
  return {model.mesh.nodes, model.sample_nodes, model.sample_rest_areas, model.skin_triangles,
          model.plane_modulus()};
}

}  // namespace

ContactSet make_contact_set(const FingerModel& model) {
  return make_contact_set(skin_of(model), model.friction_coefficient);
}

void report_contact(const FingerModel& model, const FingerPotential& potential, ContactSet& set) {
  const std::span<const FeaturePoints::Point> points = potential.features().points();
  std::array<FeaturePlace, FeaturePoints::kMost> places;
  std::copy(points.begin(), points.end(), places.begin());
  report_contact(skin_of(model),
                 {.potential = potential.contact(),
                  .positions = potential.contact_positions(),
                  .features = {places.data(), points.size()},
                  .feature_depth = FeaturePoints::kDepth,
                  .tolerance = model.contact_tolerance,
                  .X_WF = potential.bone_pose()},
                 set);
}

}  // namespace softfinger
