#include "softfinger/session/report/scene_report.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/session/report/run_report.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

/// mm, without the noise of having been metres.
double in_mm(double metres) { return std::round(metres / mm * 1e9) / 1e9; }

Json sizes_of(const HalfSpace&) { return Json::object(); }
Json sizes_of(const Ball& ball) { return {{"radius_mm", in_mm(ball.radius)}}; }
Json sizes_of(const RoundedBox& box) {
  const Vector3 size = 2.0 * box.half_size;
  return {{"size_mm", {in_mm(size.x()), in_mm(size.y()), in_mm(size.z())}},
          {"edge_radius_mm", in_mm(box.edge_radius)}};
}
Json sizes_of(const RoundedCylinder& cylinder) {
  return {{"radius_mm", in_mm(cylinder.radius)},
          {"length_mm", in_mm(2.0 * cylinder.half_length)},
          {"edge_radius_mm", in_mm(cylinder.edge_radius)}};
}

Json sizes_of(const TaperedCapsule& capsule) {
  return {{"back_mm", in_mm(capsule.back)},
          {"front_mm", in_mm(capsule.front)},
          {"length_mm", in_mm(2.0 * capsule.half_length)}};
}

Json sizes_of(const MeshShape& mesh) {
  const auto& content = mesh->content();
  const Vector3 size = content.bounds.sizes();
  return {{"file", mesh->source().lexically_normal().string()},
          {"triangles", content.triangle_count},
          {"size_mm", {in_mm(size.x()), in_mm(size.y()), in_mm(size.z())}},
          {"grid_spacing_mm", in_mm(content.levels.front().spacing)},
          {"grid_memory_MB", mesh->memory() >> 20}};
}

Json sizes_of(const SoftSolid& solid) {
  Eigen::AlignedBox3d box;
  for (const Vector3& node : solid.mesh.nodes) box.extend(node);
  const Vector3 size = box.sizes();
  return {{"file", solid.file.lexically_normal().string()},
          {"tetrahedra", solid.mesh.tetrahedra.size()},
          {"samples", solid.sample_nodes.size()},
          {"size_mm", {in_mm(size.x()), in_mm(size.y()), in_mm(size.z())}}};
}

double in_g(double mass) { return std::round(mass / unit_scale("mass_g") * 1e9) / 1e9; }

Json describe(const Joint& joint, const Scene& scene) {
  Json json{{"kind", row_of(kJointKinds, joint.kind).name}, {"parent", nullptr}};
  if (joint.parent >= 0)
    json["parent"] = scene.objects[static_cast<std::size_t>(joint.parent)].name;
  return json;
}

Json describe(const VirtualObject& object, const Scene& scene) {
  Json json{{"name", object.name}, {"shape", object.soft ? kSoftShape : name_of(object.shape)}};
  json.update(object.soft
                  ? sizes_of(*object.soft)
                  : std::visit([](const auto& shape) { return sizes_of(shape); }, object.shape));
  json["friction_coefficient"] = nullptr;
  if (object.friction_coefficient) json["friction_coefficient"] = *object.friction_coefficient;
  json["moves"] = object.motion.moves() || object.moves_by_forces();
  if (object.soft) {
    json["mass_g"] = in_g(object.soft->mass());
    json["joint"] = nullptr;
  }
  if (!object.dynamics) return json;
  json["mass_g"] = in_g(object.dynamics->mass);
  json["joint"] = nullptr;
  if (object.dynamics->joint) json["joint"] = describe(*object.dynamics->joint, scene);
  if (object.hand() >= 0) {
    json["hand"] = scene.hands[static_cast<std::size_t>(object.hand())].name;
  }
  return json;
}

Json describe(const SceneHand& hand, const Scene& scene) {
  const VirtualObject& bone = scene.objects[hand.first_object];
  const TrackerKind tracker = hand.script ? TrackerKind::kScript : TrackerKind::kWebXr;
  Json json{{"name", hand.name},
            {"side", name_of(hand.side)},
            {"tracker", row_of(kTrackers, tracker).name},
            {"bones", kHandPieces.size()},
            {"force_limit_N", bone.dynamics->following->force_limit},
            {"duration_s", nullptr}};
  if (hand.script) json["duration_s"] = hand.script->end_time();
  return json;
}

Json describe(const SceneFinger& finger, const FingerModel& model, const Device* device,
              std::optional<double> duration) {
  Json json{{"name", finger.name},
            {"model", finger.model.lexically_normal().string()},
            {"samples", model.sample_nodes.size()},
            {"tetrahedra", model.mesh.tetrahedra.size()},
            {"device", nullptr},
            {"device_kind", nullptr},
            {"tracker", finger.tracker},
            {"duration_s", nullptr}};
  if (device != nullptr) {
    json["device"] = finger.device->lexically_normal().string();
    json["device_kind"] = device->kind();
    json["mount_shift_mm"] = in_mm(device->settings().mount_shift);
  }
  if (duration) json["duration_s"] = *duration;
  return json;
}

}  // namespace

Json scene_report(const std::filesystem::path& file, const LoadObserver& observer) {
  SetupOptions options;
  options.scene = file;
  options.load_observer = observer;
  const std::shared_ptr<const RunSetup> setup = load_setup(options);
  const Scene& scene = setup->scene;
  Json fingers = Json::array();
  std::optional<double> longest;
  for (std::size_t i = 0; i < scene.fingers.size(); ++i) {
    const SceneFinger& finger = scene.fingers[i];
    const auto tracker = finger.make_tracker(scene.file.parent_path());
    const std::optional<double> end = tracker->end_time();
    if (end) longest = std::max(longest.value_or(0.0), *end);
    fingers.push_back(describe(finger, *setup->models[i], setup->devices[i].get(), end));
    fingers.back()["notices"] = notices_json(setup->notices[i]);
  }
  Json hands = Json::array();
  for (const SceneHand& hand : scene.hands) {
    hands.push_back(describe(hand, scene));
    if (hand.script) longest = std::max(longest.value_or(0.0), hand.script->end_time());
  }
  Json objects = Json::array();
  for (const VirtualObject& object : scene.objects) objects.push_back(describe(object, scene));
  Json result{{"scene", scene.file.string()},
              {"description", scene.description},
              {"simulation_Hz", scene.simulation_rate},
              {"duration_s", nullptr},
              {"fingers", std::move(fingers)},
              {"objects", std::move(objects)},
              {"hands", std::move(hands)}};
  if (longest) result["duration_s"] = *longest;
  return result;
}

}  // namespace softfinger
