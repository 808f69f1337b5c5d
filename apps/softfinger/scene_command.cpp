#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/session/report/scene_report.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

struct SceneCheckFlags {
  std::string scene;
  bool json = false;
};

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
  const auto text = [](const Json& value, const char* key) {
    return value.at(key).get<std::string>();
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
    ProgressBar bar;
    const Json summary = scene_report(flags->scene, load_observer(bar));
    bar.clear();
    if (flags->json) {
      fmt::print("{}\n", summary.dump(2));
    } else {
      print_summary(summary);
    }
  });
}
