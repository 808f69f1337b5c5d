#include "softfinger/viewer/scene_message.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "softfinger/actuation/device_state.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/mesh_drawing.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/recording/latency_stages.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

// A drawing needs no more than a micrometre; fewer digits make the message a third as long.
double rounded_mm(double metres) { return std::round(metres / mm * 1e3) / 1e3; }

Json flat(const std::vector<Vector3>& points) {
  Json array = Json::array();
  for (const Vector3& point : points) {
    for (const double coordinate : point) array.push_back(rounded_mm(coordinate));
  }
  return array;
}

Json flat(const std::vector<std::array<int, 3>>& triangles) {
  Json array = Json::array();
  for (const auto& triangle : triangles) {
    for (const int index : triangle) array.push_back(index);
  }
  return array;
}

struct SizesToJson {
  Json operator()(const HalfSpace&) const { return Json::object(); }
  Json operator()(const Ball& ball) const { return {{"radius_mm", ball.radius / mm}}; }
  Json operator()(const RoundedBox& box) const {
    return {{"size_mm",
             {2 * box.half_size.x() / mm, 2 * box.half_size.y() / mm, 2 * box.half_size.z() / mm}},
            {"edge_radius_mm", box.edge_radius / mm}};
  }
  Json operator()(const RoundedCylinder& cylinder) const {
    return {{"radius_mm", cylinder.radius / mm},
            {"length_mm", 2 * cylinder.half_length / mm},
            {"edge_radius_mm", cylinder.edge_radius / mm}};
  }
  Json operator()(const TaperedCapsule& capsule) const {
    const TriangleMesh drawing = drawing_of(capsule);
    return {{"positions_mm", flat(drawing.positions)}, {"triangles", flat(drawing.triangles)}};
  }
  Json operator()(const MeshShape& mesh) const {
    const TriangleMesh& drawing = mesh->content().drawing;
    return {{"positions_mm", flat(drawing.positions)}, {"triangles", flat(drawing.triangles)}};
  }
};

Json to_json(const Shape& shape) {
  // Clients draw meshes; a capsule is one to them.
  const bool drawn = std::holds_alternative<TaperedCapsule>(shape);
  Json json{{"kind", drawn ? row_of(kShapes, ShapeKind::kMesh).name : name_of(shape)}};
  json.update(std::visit(SizesToJson{}, shape));
  return json;
}

/// Alike shapes in a row are told once.
Json pieces_json(const std::vector<Shape>& pieces) {
  Json runs = Json::array();
  for (const Shape& piece : pieces) {
    Json shape = to_json(piece);
    if (!runs.empty() && runs.back()["shape"] == shape) {
      runs.back()["count"] = runs.back()["count"].get<int>() + 1;
    } else {
      runs.push_back({{"shape", std::move(shape)}, {"count", 1}});
    }
  }
  return runs;
}

Json to_json(const WorkspaceOutline& workspace) {
  Json reaches = Json::array();
  for (const AxisReach& reach : workspace.reaches) {
    reaches.push_back(
        {{"name", reach.name}, {"min", reach.min / reach.unit}, {"max", reach.max / reach.unit}});
  }
  Json layers = Json::array();
  for (const WorkspaceOutline::TiltLayer& layer : workspace.tilt_layers) {
    Json tilts = Json::array();
    for (const double tilt : layer.tilts) tilts.push_back(std::round(tilt / deg * 1e3) / 1e3);
    layers.push_back({{"travel_mm", rounded_mm(layer.travel)}, {"tilts_deg", std::move(tilts)}});
  }
  return {{"reaches", std::move(reaches)},
          {"tilt_layers", std::move(layers)},
          {"pitch_axis", workspace.pitch_axis},
          {"roll_axis", workspace.roll_axis},
          {"travel_axis", workspace.travel_axis}};
}

/// Null for a finger that no headset moves.
Json headset_json(const SceneDescription::Finger& finger) {
  if (!finger.in_headset) return nullptr;
  const Vector3 p = finger.X_WFt_start.translation / mm;
  const Eigen::Quaterniond q(finger.X_WFt_start.rotation);
  return {{"hand", name_of(finger.hand_side)},
          {"finger", name_of(finger.hand_finger)},
          {"start", {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}}};
}

/// The most urgent first.
Json device_states_json() {
  Json states = Json::array();
  for (const DeviceStateRow& state : kDeviceStates) {
    states.push_back(
        {{"name", state.name}, {"tone", kToneNames.at(static_cast<std::size_t>(state.tone))}});
  }
  return states;
}

Json latency_stages_json() {
  Json stages = Json::array();
  for (const auto& stage : kLatencyStageNames) {
    stages.push_back({{"name", stage.name}, {"words", stage.words}});
  }
  return stages;
}

Json to_json(const SceneDescription::Finger& finger) {
  return {{"name", finger.name},
          {"skin_positions_mm", flat(finger.skin_rest_positions_F)},
          {"skin_triangles", flat(finger.skin_triangles)},
          {"rigid_positions_mm", flat(finger.rigid_positions_F)},
          {"bone_triangles", flat(finger.bone_triangles)},
          {"nail_triangles", flat(finger.nail_triangles)},
          {"device_kind", finger.device_kind},
          {"device_kind_words", finger.device_kind_words},
          {"cables", finger.cables},
          {"configuration_names", finger.configuration_names},
          {"objectives", finger.objectives},
          {"joint_unit", finger.linear_joints ? "mm" : "deg"},
          {"disk_radius_mm", finger.disk_radius / mm},
          {"legs", finger.legs},
          {"pieces", pieces_json(finger.pieces)},
          {"cap_radius_mm", finger.cap_radius / mm},
          {"workspace", to_json(finger.workspace)},
          {"twin", finger.twin},
          {"moved_here", finger.moved_here},
          {"registrable", finger.registrable},
          {"fittable", finger.fittable},
          {"fits_by_touch", finger.fits_by_touch},
          {"headset", headset_json(finger)}};
}

}  // namespace

std::string scene_message(const SceneDescription& scene) {
  Json message = {{"type", "scene"},
                  {"protocol_version", kProtocolVersion},
                  {"generation", scene.generation},
                  {"scene", scene.scene_name},
                  {"scenes", scene.scene_names},
                  {"duration_s", scene.duration},
                  {"objects", Json::array()},
                  {"fingers", Json::array()},
                  {"notices", Json::array()},
                  {"objectives", Json::array()},
                  {"device_states", device_states_json()},
                  {"latency_stages", latency_stages_json()}};
  for (const auto& object : scene.objects) {
    Json shape = object.triangles.empty() ? to_json(object.shape)
                                          : Json{{"kind", kSoftShape},
                                                 {"positions_mm", flat(object.positions_O)},
                                                 {"triangles", flat(object.triangles)}};
    message["objects"].push_back({{"name", object.name},
                                  {"shape", std::move(shape)},
                                  {"hand", object.hand.empty() ? Json() : Json(object.hand)},
                                  {"holdable", object.can_be_held},
                                  {"joint", object.joint.empty() ? Json() : Json(object.joint)}});
  }
  for (const auto& finger : scene.fingers) message["fingers"].push_back(to_json(finger));
  for (const auto& notice : scene.notices) {
    message["notices"].push_back(
        {{"finger", notice.finger}, {"kind", notice.kind}, {"text", notice.text}});
  }
  for (const auto& objective : scene.objectives) {
    message["objectives"].push_back({{"name", objective.name}, {"words", objective.words}});
  }
  // Names come from files and may hold broken UTF-8; that must not end the viewer.
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace softfinger
