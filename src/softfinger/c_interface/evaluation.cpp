#include "softfinger/session/evaluation.hpp"

#include <cstddef>
#include <nlohmann/json.hpp>

#include "softfinger/base/name_table.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/session/report/evaluation_report.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kFirstEvaluate = offsetof(sf_evaluate_options, progress);

struct FrameColumn {
  std::string_view name;
  double (*value)(const EvaluatedFrame& frame);
};
constexpr FrameColumn kFrameColumns[] = {
    {"time_s", [](const EvaluatedFrame& frame) { return frame.time; }},
    {"finger", [](const EvaluatedFrame& frame) { return double(frame.finger); }},
    {"virtual_force_N", [](const EvaluatedFrame& frame) { return frame.virtual_force; }},
    {"virtual_force_sum_N", [](const EvaluatedFrame& frame) { return frame.virtual_force_sum; }},
    {"twin_force_N", [](const EvaluatedFrame& frame) { return frame.twin_force; }},
    {"twin_force_sum_N", [](const EvaluatedFrame& frame) { return frame.twin_force_sum; }},
    {"virtual_contact_area_mm2",
     [](const EvaluatedFrame& frame) { return frame.virtual_area / mm2; }},
    {"twin_contact_area_mm2", [](const EvaluatedFrame& frame) { return frame.twin_area / mm2; }},
};

/// Where the device was commanded to, where its servos are, and where its motors hold it.
struct FrameMeasures {
  std::string_view prefix;
  RenderingMeasures (*of)(const EvaluatedFrame& frame);
};
constexpr FrameMeasures kFrameMeasures[] = {
    {"", [](const EvaluatedFrame& frame) { return frame.commanded; }},
    {"lagged_",
     [](const EvaluatedFrame& frame) { return frame.lagged.value_or(RenderingMeasures{}); }},
    {"loaded_",
     [](const EvaluatedFrame& frame) { return frame.loaded.value_or(RenderingMeasures{}); }},
};

const ObjectiveKind& named_objective(std::string_view name) {
  if (const ObjectiveKind* kind = objective_kind(name)) return *kind;
  throw InputError("objective: unknown name '" + std::string(name) + "'; there is " +
                   listed(names_of(objective_kinds()), "or"));
}

EvaluationOptions evaluation_options(const char* scene, const sf_evaluate_options& given) {
  EvaluationOptions options;
  RunOptions& run = options.run;
  run.scene = scene;
  if (given.device != nullptr) run.devices.emplace_back(given.device);
  if (given.tracker != nullptr) run.trackers.emplace_back(given.tracker);
  if (given.wearer != nullptr) run.wearer = given.wearer;
  if (given.person != nullptr) run.person = given.person;
  if (given.objective != nullptr) run.objective = &named_objective(given.objective);
  run.duration = duration_of(given.duration_s);
  return options;
}

std::unique_ptr<Table> table_of(const Evaluation& evaluation) {
  auto table = std::make_unique<Table>();
  for (const FrameColumn& column : kFrameColumns) {
    table->add_column(column.name);
    for (const EvaluatedFrame& frame : evaluation.frames) {
      table->columns.back().values.push_back(column.value(frame));
    }
  }
  for (const FrameMeasures& side : kFrameMeasures) {
    for (const MeasureName& measure : measure_names()) {
      table->add_column(std::string(side.prefix) + std::string(measure.name));
      for (const EvaluatedFrame& frame : evaluation.frames) {
        table->columns.back().values.push_back(side.of(frame).*measure.member / measure.unit);
      }
    }
  }
  table->text = evaluation_report(evaluation).dump(2);
  return table;
}

}  // namespace
}  // namespace softfinger

sf_status sf_evaluate(const char* scene, const sf_evaluate_options* options, sf_table** out,
                      char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (scene == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "scene and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const sf_evaluate_options given =
        softfinger::taken(options, softfinger::kFirstEvaluate, "sf_evaluate_options");
    const softfinger::HostWatch host(given.stop, given.progress);
    const softfinger::EvaluationOptions how = softfinger::evaluation_options(scene, given);
    *out =
        new sf_table(softfinger::table_of(softfinger::evaluate(how, host.stop(), host.observer())));
    return SF_DONE;
  });
}
