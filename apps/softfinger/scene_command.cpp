#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/geometry/signed_distance_grid.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/session/report/run_report.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

struct SceneCheckFlags {
  std::string scene;
  bool json = false;
};

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

/// Loads all that a run would.
Json check(const std::string& file) {
  RunOptions options;
  options.scene = file;
  ProgressBar bar;
  options.load_observer = load_observer(bar);
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

std::string sizes(const Json& object) {
  const auto number = [&](const char* key) { return object.at(key).get<double>(); };
  const NameRow<ShapeKind>* const row = row_named(kShapes, object.at("shape").get<std::string>());
  if (row == nullptr) {  // soft
    return fmt::format(" {}, {} tetrahedra, {:.4g} mm", object.at("file").get<std::string>(),
                       object.at("tetrahedra").get<std::uint64_t>(),
                       fmt::join(object.at("size_mm").get<std::vector<double>>(), " x "));
  }
  switch (row->value) {
    case ShapeKind::kPlane:
      break;
    case ShapeKind::kSphere:
      return fmt::format(", radius {} mm", number("radius_mm"));
    case ShapeKind::kBox:
      return fmt::format(", {} mm, edge radius {} mm",
                         fmt::join(object.at("size_mm").get<std::vector<double>>(), " x "),
                         number("edge_radius_mm"));
    case ShapeKind::kCylinder:
      return fmt::format(", radius {} mm, length {} mm, edge radius {} mm", number("radius_mm"),
                         number("length_mm"), number("edge_radius_mm"));
    case ShapeKind::kCapsule:
      return fmt::format(", radii {} and {} mm, length {} mm", number("back_mm"),
                         number("front_mm"), number("length_mm"));
    case ShapeKind::kMesh:
      return fmt::format(" {}, {} triangles, {:.4g} mm", object.at("file").get<std::string>(),
                         object.at("triangles").get<std::uint64_t>(),
                         fmt::join(object.at("size_mm").get<std::vector<double>>(), " x "));
  }
  return "";
}

/// How an object moves, for people.
std::string motion(const Json& object) {
  if (!object.contains("mass_g")) return object.at("moves").get<bool>() ? ", moves" : "";
  std::string words = fmt::format(", {:.6g} g", object.at("mass_g").get<double>());
  const Json& joint = object.at("joint");
  if (joint.is_null()) return words + ", free";
  const Json& parent = joint.at("parent");
  return words + fmt::format(", {} on {}", joint.at("kind").get<std::string>(),
                             parent.is_null() ? "the world" : parent.get<std::string>());
}

void print_summary(const Json& scene) {
  const auto text = [](const Json& json, const char* key) {
    return json.at(key).get<std::string>();
  };
  fmt::print("{}: good\n", text(scene, "scene"));
  if (const std::string line = text(scene, "description"); !line.empty())
    fmt::print("  {}\n", line);
  for (const Json& finger : scene.at("fingers")) {
    const Json& duration = finger.at("duration_s");
    fmt::print("  finger {}: {} ({} skin samples, {} tetrahedra), {}, tracker {}{}\n",
               text(finger, "name"), text(finger, "model"), finger.at("samples").get<int>(),
               finger.at("tetrahedra").get<int>(),
               finger.at("device").is_null()
                   ? "no device"
                   : fmt::format("{} ({})", text(finger, "device"), text(finger, "device_kind")),
               text(finger, "tracker"),
               duration.is_null() ? "" : fmt::format(", {:g} s", duration.get<double>()));
    if (const double shift = finger.value("mount_shift_mm", 0.0); shift != 0.0) {
      fmt::print("    its mount stands {:g} mm further {}, to fit the finger\n", std::abs(shift),
                 shift > 0.0 ? "out" : "in");
    }
    for (const Json& notice : finger.at("notices")) {
      fmt::print("    {}: {}\n", text(notice, "key"), text(notice, "text"));
    }
  }
  for (const Json& hand : scene.at("hands")) {
    fmt::print("  hand {}: {}, {} bones, each pulled by at most {:g} N, tracker {}\n",
               text(hand, "name"), text(hand, "side"), hand.at("bones").get<int>(),
               hand.at("force_limit_N").get<double>(), text(hand, "tracker"));
  }
  for (const Json& object : scene.at("objects")) {
    if (object.contains("hand")) continue;
    const Json& friction = object.at("friction_coefficient");
    fmt::print("  object {}: {}{}, friction {}{}\n", text(object, "name"), text(object, "shape"),
               sizes(object),
               friction.is_null() ? "of the finger" : fmt::format("{}", friction.get<double>()),
               motion(object));
  }
  fmt::print("  simulation at {:g} Hz\n", scene.at("simulation_Hz").get<double>());
}

}  // namespace

void add_scene_command(CLI::App& app) {
  CLI::App* scene = app.add_subcommand("scene", "Look at scene files");
  CLI::App* describing = scene->add_subcommand("schema", "JSON Schema of scene files");
  describing->callback([] { fmt::print("{}\n", scene_schema()); });
  scene->require_subcommand(1);
  CLI::App* command =
      scene->add_subcommand("check", "Read a scene and every file it names; say what is in it");
  auto flags = std::make_shared<SceneCheckFlags>();
  takes_shipped(
      command->add_option("SCENE", flags->scene, "scene file (TOML), or the name of a shipped one"),
      Shipped::kScene)
      ->required();
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] {
    const Json summary = check(flags->scene);
    if (flags->json) {
      fmt::print("{}\n", summary.dump(2));
    } else {
      print_summary(summary);
    }
  });
}
