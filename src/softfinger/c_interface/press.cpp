#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>

#include "softfinger/base/units.hpp"
#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/identification/indentation_columns.hpp"
#include "softfinger/identification/indentation_export.hpp"

namespace softfinger {
namespace {

constexpr double kDefaultDepth = 2e-3;  // m
constexpr int kDefaultRows = 20;
// What the struct was when it was first published: whoever was compiled then still runs.
constexpr std::size_t kFirstPress = offsetof(sf_press_options, stop);

/// Leaves a press whose host wants no more of it.
struct HostHasEnough {};

sf_press_options press_options(const sf_press_options* given) {
  sf_press_options options = taken(given, kFirstPress, "sf_press_options");
  if (options.rows == 0) options.rows = kDefaultRows;
  if (options.depth_m == 0.0) options.depth_m = kDefaultDepth;
  return options;
}

void check_range(const char* key, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw InputError(fmt::format("{} {}: must be from {} to {}", key, value, least, most));
}

/// The ranges of `softfinger press`.
void check_press(const sf_press_options& options) {
  check_range("rows", options.rows, 1, 10000);
  check_range("depth_m", options.depth_m, 1e-9, 0.02);
  check_range("sphere_radius_m", options.sphere_radius_m, 0.0, 1.0);
  for (const double at : options.at_m) check_range("at_m", at, -0.1, 0.1);
  check_range("edge_radius_m", options.edge_radius_m, 0.0, 0.1);
  check_range("pitch_rad", options.pitch_rad, -89.0 * deg, 89.0 * deg);
  check_range("speed_m_per_s", options.speed_m_per_s, 0.0, 1.0);
  check_range("hold_s", options.hold_s, 0.0, 60.0);
  if (options.edge != 0 && options.sphere_radius_m > 0.0) {
    throw InputError("edge and sphere_radius_m: give one of them");
  }
  if (options.relaxed != 0 && options.speed_m_per_s > 0.0) {
    throw InputError("relaxed and speed_m_per_s: give one of them");
  }
  if (options.hold_s > 0.0 && options.speed_m_per_s == 0.0) {
    throw InputError("hold_s: needs speed_m_per_s, for a quasi-static press knows no time");
  }
}

Indenter indenter_of(const sf_press_options& options) {
  if (options.sphere_radius_m > 0.0) {
    return Indenter::ball(options.sphere_radius_m, options.at_m[0], options.at_m[1]);
  }
  return options.edge != 0 ? Indenter::edge(options.edge_radius_m) : Indenter::plane();
}

std::unique_ptr<Table> pressed(const char* finger, const sf_press_options& options) {
  check_press(options);
  IndentationOptions how;
  how.depth = options.depth_m;
  how.rows = options.rows;
  how.pitch = options.pitch_rad;
  how.strain_limits = options.no_strain_limits == 0;
  how.friction = options.no_friction == 0;
  how.relaxed = options.relaxed != 0;
  how.speed = options.speed_m_per_s;
  how.hold = options.hold_s;
  how.unload = options.unload != 0;
  const auto model = FingerModel::load(file_or_shipped(Shipped::kFinger, finger));
  std::optional<IndentationExport> files;
  if (options.export_folder != nullptr) files.emplace(options.export_folder, *model);
  auto table = std::make_unique<Table>();
  for (const IndentationColumn& column : indentation_columns()) table->add_column(column.name);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  bool all_converged = true;
  const double all = how.rows * (1.0 + (how.hold > 0.0 ? 1.0 : 0.0) + (how.unload ? 1.0 : 0.0));
  const auto take = [&](const IndentationState& state) {
    all_converged = all_converged && state.row.converged;
    nlohmann::ordered_json row;
    auto to = table->columns.begin();
    for (const IndentationColumn& column : indentation_columns()) {
      const double value = column.value(state.row);
      (to++)->values.push_back(value);
      nlohmann::ordered_json& told = row[std::string(column.name)] = value;
      if (column.whole) told = static_cast<int>(value);
    }
    rows.push_back(std::move(row));
    if (files) files->write(static_cast<int>(rows.size()), state);
    if (options.progress != nullptr) *options.progress = static_cast<double>(rows.size()) / all;
    if (options.stop != nullptr && *options.stop != 0) throw HostHasEnough{};
  };
  try {
    indent(*model, indenter_of(options), how, take);
  } catch (const HostHasEnough&) {  // the rows until then
  }
  if (files) files->close();
  if (!all_converged) throw OperationError("press: some rows did not reach equilibrium");
  table->text = rows.dump();
  return table;
}

}  // namespace
}  // namespace softfinger

sf_status sf_press(const char* finger, const sf_press_options* options, sf_table** out, char* error,
                   size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (finger == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "finger and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_table(softfinger::pressed(finger, softfinger::press_options(options)));
    return SF_DONE;
  });
}
