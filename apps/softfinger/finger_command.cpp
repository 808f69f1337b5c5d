#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "finger_fit_command.hpp"
#include "finger_register_command.hpp"
#include "rounded.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/person/person.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

struct FingerShowFlags {
  std::string finger;
  bool json = false;
};

Json in_mm(const Vector3& metres) {
  return {micro_rounded(metres.x() / mm), micro_rounded(metres.y() / mm),
          micro_rounded(metres.z() / mm)};
}

Json mesh_statistics(const FingerModel& model) {
  const TetrahedralMesh& mesh = model.mesh;
  Eigen::AlignedBox3d box;
  double volume = 0.0, area = 0.0;
  for (const int node : model.sample_nodes) {
    box.extend(mesh.nodes[static_cast<std::size_t>(node)]);
  }
  for (const auto& tetrahedron : mesh.tetrahedra) {
    const auto arm = [&](std::size_t k) {
      return Vector3(mesh.nodes[static_cast<std::size_t>(tetrahedron[k])] -
                     mesh.nodes[static_cast<std::size_t>(tetrahedron[0])]);
    };
    volume += arm(1).cross(arm(2)).dot(arm(3)) / 6.0;
  }
  for (const double sample : model.sample_rest_areas) area += sample;
  const auto rigid = std::count(model.node_is_rigid.begin(), model.node_is_rigid.end(), true);
  return {{"tetrahedra", mesh.tetrahedra.size()},
          {"nodes", mesh.nodes.size()},
          {"rigid_nodes", rigid},
          {"skin_samples", model.sample_nodes.size()},
          {"skin_triangles", model.skin_triangles.size()},
          {"volumes", mesh.volume_names},
          {"surfaces", mesh.surface_names},
          {"skin_min_mm", in_mm(box.min())},
          {"skin_max_mm", in_mm(box.max())},
          {"skin_area_mm2", micro_rounded(area / mm2)},
          {"volume_mm3", micro_rounded(volume / (mm * mm2))}};
}

/// A file's keys as text, one a line under their tables.
void print_table(const Json& table, const std::string& path) {
  for (const auto& [key, value] : table.items()) {
    if (!value.is_object()) fmt::print("  {} = {}\n", key, value.dump());
  }
  for (const auto& [key, value] : table.items()) {
    if (!value.is_object()) continue;
    const std::string name = path.empty() ? key : path + "." + key;
    fmt::print("[{}]\n", name);
    print_table(value, name);
  }
}

void print_statistics(const Json& mesh) {
  const auto count = [&](const char* key) { return mesh.at(key).get<std::int64_t>(); };
  const auto size = [&](std::size_t axis) {
    return mesh.at("skin_max_mm").at(axis).get<double>() -
           mesh.at("skin_min_mm").at(axis).get<double>();
  };
  fmt::print("  {} tetrahedra, {} nodes ({} rigid), {} skin samples\n", count("tetrahedra"),
             count("nodes"), count("rigid_nodes"), count("skin_samples"));
  fmt::print(
      "  skin {:.1f} mm long, {:.1f} mm broad, {:.1f} mm deep, {:.0f} mm2; tissue {:.0f} mm3\n",
      size(0), size(1), size(2), mesh.at("skin_area_mm2").get<double>(),
      mesh.at("volume_mm3").get<double>());
}

void show(const FingerShowFlags& flags) {
  const auto model = FingerModel::load(flags.finger);
  Json keys = Json::parse(model->as_read);
  const Json statistics = mesh_statistics(*model);
  if (flags.json) {
    keys["mesh_statistics"] = statistics;
    fmt::print("{}\n", keys.dump(2));
    return;
  }
  fmt::print("{}\n", flags.finger);
  print_statistics(statistics);
  print_table(keys, "");
}

}  // namespace

void add_finger_command(CLI::App& app) {
  CLI::App* finger = app.add_subcommand(
      "finger", "Look at finger files, fit one to a measured press, register a person's finger");
  finger->require_subcommand(1);
  CLI::App* command =
      finger->add_subcommand("show", "Read a finger file and its mesh; say what is in them");
  auto flags = std::make_shared<FingerShowFlags>();
  takes_shipped(command->add_option("FINGER", flags->finger,
                                    "finger file (TOML), or the name of a shipped one"),
                Shipped::kFinger)
      ->required();
  command->add_flag("--json", flags->json,
                    "one JSON object on stdout: the file's keys, defaults filled in");
  command->callback([flags] { show(*flags); });
  CLI::App* describing =
      finger->add_subcommand("schema", "JSON Schema of finger files, or of person files");
  auto of_person = std::make_shared<bool>(false);
  describing->add_flag("--person", *of_person, "of the files that --person takes");
  describing->callback(
      [of_person] { fmt::print("{}\n", *of_person ? person_schema() : finger_schema()); });
  add_finger_fit_command(*finger);
  add_finger_register_command(*finger);
}
