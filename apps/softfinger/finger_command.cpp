#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "finger_fit_command.hpp"
#include "finger_register_command.hpp"
#include "shipped_option.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/session/report/finger_report.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

struct FingerShowFlags {
  std::string finger;
  bool json = false;
};

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
  Json keys = finger_report(*FingerModel::load(flags.finger));
  if (flags.json) {
    fmt::print("{}\n", keys.dump(2));
    return;
  }
  fmt::print("{}\n", flags.finger);
  print_statistics(keys.at("mesh_statistics"));
  keys.erase("mesh_statistics");
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
