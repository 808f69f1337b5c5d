#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/device_objectives.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/session/report/evaluation_report.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "stop_signal.hpp"

namespace {

using namespace softfinger;

struct EvaluateFlags {
  EvaluationOptions options;
  std::optional<double> duration_s;
  std::string wearer, person, objective;
  bool json = false;
};

std::string objective_help() {
  std::vector<std::string> kinds;
  for (const ObjectiveKind& kind : objective_kinds()) {
    kinds.push_back(fmt::format("{} ({})", kind.name, kind.words));
  }
  return fmt::format("what the device is led by, instead of what its file says: {}",
                     fmt::join(kinds, ", "));
}

void evaluate_scene(EvaluateFlags flags) {
  if (flags.duration_s && !(std::isfinite(*flags.duration_s) && *flags.duration_s > 0.0)) {
    throw InputError(
        fmt::format("--duration-s {}: must be a time above 0 in seconds", *flags.duration_s));
  }
  flags.options.run.duration = flags.duration_s;
  if (!flags.wearer.empty()) flags.options.run.wearer = flags.wearer;
  if (!flags.person.empty()) flags.options.run.person = flags.person;
  if (!flags.objective.empty()) flags.options.run.objective = objective_kind(flags.objective);

  ProgressBar bar;
  flags.options.run.load_observer = load_observer(bar);
  RunObserver observer;
  observer.message = [&bar](const std::string& message) {
    bar.clear();
    fmt::print(stderr, "softfinger: {}\n", message);
  };
  observer.progress = [&bar](double time, std::optional<double> end) {
    if (end && *end > 0.0) bar.show(time / *end);
  };
  const Evaluation evaluation = evaluate(flags.options, stop_on_signals(), observer);
  bar.clear();
  if (flags.json) {
    fmt::print("{}\n", evaluation_report(evaluation).dump(2));
  } else {
    fmt::print("{}", evaluation_report_text(evaluation));
  }
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "How faithfully a device renders a scene: a second finger feels its commands");
  auto flags = std::make_shared<EvaluateFlags>();
  RunOptions& run = flags->options.run;
  takes_shipped(
      command->add_option("SCENE", run.scene, "scene file (TOML), or the name of a shipped one"),
      Shipped::kScene)
      ->required();
  command
      ->add_option("--device", run.devices,
                   "device file instead of the scene's; NAME=FILE for one of several fingers")
      ->type_name(value_name(Shipped::kDevice))
      ->allow_extra_args(false);
  command
      ->add_option(
          "--tracker", run.trackers,
          fmt::format(
              "tracker instead of the scene's: {}; NAME=SPEC for one of several fingers",
              trackers_in_brief(
                  "or", [](const TrackerRow& row) { return row.origin == PoseOrigin::kMotion; })))
      ->allow_extra_args(false);
  takes_shipped(command->add_option(
                    "--wearer", flags->wearer,
                    "finger file of who wears the device; the simulated finger where not given"),
                Shipped::kFinger);
  command->add_option(
      "--person", flags->person,
      "person file: sizes, skin and mounts of the fingers, where tracked bodies sit on them");
  command->add_option("--objective", flags->objective, objective_help())
      ->check(CLI::IsMember(objective_words()));
  command->add_option("--duration-s", flags->duration_s, "end after this time, s");
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { evaluate_scene(*flags); });
}
