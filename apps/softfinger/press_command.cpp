#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"
#include "softfinger/identification/indentation_columns.hpp"
#include "softfinger/identification/indentation_export.hpp"

namespace {

using softfinger::InputError;

struct PressFlags {
  std::string finger;
  double to_mm = 2.0;
  int steps = 20;
  std::optional<double> sphere_mm;
  bool edge = false;
  double edge_radius_mm = 1.0;
  std::vector<double> at_mm{0.0, 0.0};
  double angle_deg = 0.0;
  bool no_strain_limits = false;
  bool no_friction = false;
  bool relaxed = false;
  double speed_mm_per_s = 0.0;
  double hold_ms = 0.0;
  bool unload = false;
  std::string export_directory;
  bool json = false;
  bool csv = false;
};

void check(const PressFlags& flags) {
  const auto refuse = [](const std::string& what) { throw InputError("press: " + what); };
  if (!(flags.to_mm > 0.0 && flags.to_mm <= 20.0)) {
    refuse(fmt::format("--to-mm {}: must be above 0 and at most 20", flags.to_mm));
  }
  if (flags.steps < 1 || flags.steps > 10000) {
    refuse(fmt::format("--steps {}: must be from 1 to 10000", flags.steps));
  }
  if (flags.sphere_mm && !(*flags.sphere_mm > 0.0 && *flags.sphere_mm <= 1000.0)) {
    refuse(fmt::format("--sphere-mm {}: must be above 0 and at most 1000", *flags.sphere_mm));
  }
  if (!(flags.edge_radius_mm >= 0.0 && flags.edge_radius_mm <= 100.0)) {
    refuse(fmt::format("--edge-radius-mm {}: must be from 0 to 100", flags.edge_radius_mm));
  }
  if (!(std::abs(flags.angle_deg) <= 89.0)) {
    refuse(fmt::format("--angle-deg {}: must be from -89 to 89", flags.angle_deg));
  }
  for (double value : flags.at_mm) {
    if (!(std::abs(value) <= 100.0))
      refuse(fmt::format("--at-mm {}: must be from -100 to 100", value));
  }
  if (!(flags.speed_mm_per_s >= 0.0 && flags.speed_mm_per_s <= 1000.0)) {
    refuse(fmt::format("--speed-mm-per-s {}: must be from 0 to 1000", flags.speed_mm_per_s));
  }
  if (flags.sphere_mm && flags.edge) refuse("--sphere-mm and --edge: give one of them");
  if (flags.relaxed && flags.speed_mm_per_s > 0.0) {
    refuse("--relaxed and --speed-mm-per-s: give one of them");
  }
  if (!(flags.hold_ms >= 0.0 && flags.hold_ms <= 60000.0)) {
    refuse(fmt::format("--hold-ms {}: must be from 0 to 60000", flags.hold_ms));
  }
  if (flags.hold_ms > 0.0 && flags.speed_mm_per_s == 0.0) {
    refuse("--hold-ms: needs --speed-mm-per-s, for a quasi-static press knows no time");
  }
  if (flags.json && flags.csv) refuse("--json and --csv: give one of them");
}

softfinger::Indenter indenter(const PressFlags& flags) {
  using softfinger::mm;
  if (flags.sphere_mm) {
    return softfinger::Indenter::ball(*flags.sphere_mm * mm, flags.at_mm[0] * mm,
                                      flags.at_mm[1] * mm);
  }
  if (flags.edge) return softfinger::Indenter::edge(flags.edge_radius_mm * mm);
  return softfinger::Indenter::plane();
}

nlohmann::ordered_json to_json(const softfinger::IndentationRow& row) {
  nlohmann::ordered_json result;
  for (const softfinger::IndentationColumn& column : softfinger::indentation_columns()) {
    nlohmann::ordered_json& value = result[std::string(column.name)] = column.value(row);
    if (column.whole) value = static_cast<int>(column.value(row));
  }
  return result;
}

void press(const PressFlags& flags) {
  using namespace softfinger;
  check(flags);
  const auto model = FingerModel::load(flags.finger);
  IndentationOptions options;
  options.depth = flags.to_mm * mm;
  options.rows = flags.steps;
  options.pitch = flags.angle_deg * deg;
  options.strain_limits = !flags.no_strain_limits;
  options.friction = !flags.no_friction;
  options.relaxed = flags.relaxed;
  options.speed = flags.speed_mm_per_s * mm;
  options.hold = flags.hold_ms * ms;
  options.unload = flags.unload;
  std::optional<IndentationExport> files;
  if (!flags.export_directory.empty()) files.emplace(flags.export_directory, *model);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  bool all_converged = true;
  bool header = !flags.json;
  indent(*model, indenter(flags), options, [&](const IndentationState& state) {
    nlohmann::ordered_json row = to_json(state.row);
    all_converged = all_converged && state.row.converged;
    if (files) files->write(static_cast<int>(rows.size()) + 1, state);
    if (header && flags.csv) {
      std::string line;
      for (const auto& [key, value] : row.items()) line += (line.empty() ? "" : ",") + key;
      fmt::print("{}\n", line);
    } else if (header) {
      fmt::print("{:>10} {:>10} {:>10} {:>10} {:>8} {:>8} {:>8}\n", "depth mm", "force N",
                 "shear N", "area mm2", "samples", "least s", "volume");
    }
    header = false;
    if (flags.csv) {
      std::string line;
      for (const auto& [key, value] : row.items()) line += (line.empty() ? "" : ",") + value.dump();
      fmt::print("{}\n", line);
    } else if (!flags.json) {
      fmt::print("{:10.3f} {:10.4f} {:10.4f} {:10.2f} {:8} {:8.3f} {:8.4f}\n",
                 state.row.indentation / mm, state.row.normal_force, state.row.tangential_force,
                 state.row.contact_area / mm2, state.row.contact_samples, state.row.min_stretch,
                 state.row.volume_ratio);
    }
    rows.push_back(std::move(row));
  });
  if (files) files->close();
  if (flags.json) fmt::print("{}\n", rows.dump());
  if (!all_converged) throw OperationError("press: some rows did not reach equilibrium");
}

}  // namespace

void add_press_command(CLI::App& app) {
  auto flags = std::make_shared<PressFlags>();
  CLI::App* command = app.add_subcommand("press", "Press a finger on an obstacle, bone prescribed");
  takes_shipped(command->add_option("FINGER", flags->finger,
                                    "Finger file (TOML), or the name of a shipped one"),
                Shipped::kFinger)
      ->required();
  command->add_option("--to-mm", flags->to_mm, "Greatest bone displacement after first touch");
  command->add_option("--steps", flags->steps, "Number of rows");
  command->add_option("--sphere-mm", flags->sphere_mm, "Press on a sphere of this radius");
  command->add_flag("--edge", flags->edge, "Press on a 90-degree edge along y");
  command->add_option("--edge-radius-mm", flags->edge_radius_mm, "Rounding of the edge");
  command->add_option("--at-mm", flags->at_mm, "X,Y of the sphere under the finger's origin")
      ->delimiter(',')
      ->expected(2);
  command->add_option("--angle-deg", flags->angle_deg, "Pitch of the finger, distal end down");
  command->add_flag("--no-strain-limits", flags->no_strain_limits, "Linear corotated skin only");
  command->add_flag("--no-friction", flags->no_friction, "Frictionless contact");
  command->add_flag("--relaxed", flags->relaxed, "Long-time moduli: all stress that can relax has");
  command->add_option("--speed-mm-per-s", flags->speed_mm_per_s, "Step in time at this speed");
  command->add_option("--hold-ms", flags->hold_ms, "Then hold for this long: N rows more");
  command->add_flag("--unload", flags->unload, "Then back to first touch: N rows more");
  command->add_option("--export", flags->export_directory,
                      "Write nodes.csv, contact.csv, features.csv and patches.csv there");
  command->add_flag("--json", flags->json, "One JSON array of rows");
  command->add_flag("--csv", flags->csv, "Comma-separated rows");
  command->callback([flags] { press(*flags); });
}
