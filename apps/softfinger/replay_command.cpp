#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>

#include "commands.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/session/report/replay_report.hpp"

namespace {

using namespace softfinger;

struct ReplayFlags {
  ReplayOptions options;
  std::optional<std::string> scene, person;
  std::string simd;
  bool json = false;
};

void run(ReplayFlags flags) {
  choose_instruction_set(flags.simd.empty() ? recorded_instruction_set(flags.options.recording)
                                            : flags.simd);
  if (flags.scene) flags.options.scene = *flags.scene;
  if (flags.person) flags.options.person = *flags.person;
  ProgressBar bar;
  flags.options.load_observer = load_observer(bar);
  const ReplayResult result =
      replay(flags.options, [&bar](double fraction) { bar.show(fraction); });
  bar.clear();
  if (!result.cut.empty()) fmt::print(stderr, "softfinger: {}\n", result.cut);
  if (flags.json) {
    fmt::print("{}\n", replay_report(result).dump(2));
  } else if (result.agree) {
    fmt::print("{} steps agree to the bit\n", result.steps);
  } else {
    fmt::print("differs first at step {} of {}: {}\n", *result.first_difference, result.steps,
               result.difference);
  }
  if (!result.agree) throw CLI::RuntimeError(1);
}

}  // namespace

void add_replay_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "replay", "Run a recording again with its recorded input; say whether the bits agree");
  auto flags = std::make_shared<ReplayFlags>();
  command->add_option("RECORDING", flags->options.recording, "what run --record wrote")->required();
  takes_shipped(
      command->add_option("--scene", flags->scene, "run this scene instead of the recorded one"),
      Shipped::kScene);
  command->add_option("--person", flags->person,
                      "person file instead of the recorded one: sizes, skin and mounts of fingers");
  command->add_option("--simd", flags->simd,
                      "instruction set instead of the recorded one: baseline, avx2 or avx512");
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { run(*flags); });
}
