#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>

#include "commands.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/session/report/conditioning_report.hpp"

namespace {

using namespace softfinger;

struct ConditionFlags {
  std::string file, finger;
  double rate_Hz = 120.0;
  double age_ms = 15.0;
  double noise_mm = 0.1;
  double noise_deg = 0.2;
  bool filter = false;
  std::optional<double> predict_ms;
  bool json = false;
};

void print(const char* what, const ConditioningEffect::Part& part) {
  if (!(part.time > 0.0)) return;
  fmt::print("  {:<8} {:6.1f} s   {:.3f} -> {:.3f} mm   {:.2f} -> {:.2f} deg\n", what, part.time,
             part.before.distance / mm, part.after.distance / mm, part.before.turn / deg,
             part.after.turn / deg);
}

void condition(const ConditionFlags& flags) {
  ConditioningQuestion question{.motion = flags.file, .finger = flags.finger};
  question.quality = {.rate = flags.rate_Hz,
                      .age = flags.age_ms * ms,
                      .noise = flags.noise_mm * mm,
                      .turn_noise = flags.noise_deg * deg};
  question.filter = flags.filter;
  if (flags.predict_ms) question.predict = *flags.predict_ms * ms;
  const ConditioningEffect effect = conditioning_effect(question);
  if (flags.json) {
    fmt::print("{}\n", conditioning_report(effect).dump(2));
    return;
  }
  fmt::print("distance from the truth, root of the mean square, as poses come -> conditioned:\n");
  print("resting", effect.resting);
  print("moving", effect.moving);
}

}  // namespace

void add_condition_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "condition", "Say what --filter and --predict-ms would make of a recorded motion");
  auto flags = std::make_shared<ConditionFlags>();
  command->add_option("FILE", flags->file, "a recording, or a CSV file of poses: the truth")
      ->required();
  command->add_option("--finger", flags->finger, "of a recording of several fingers");
  command->add_option("--rate-Hz", flags->rate_Hz, "poses a second that the tracker sees");
  command->add_option("--age-ms", flags->age_ms, "of a pose when it arrives");
  command->add_option("--noise-mm", flags->noise_mm, "standard deviation of each coordinate");
  command->add_option("--noise-deg", flags->noise_deg, "standard deviation about each axis");
  command->add_flag("--filter", flags->filter, "smooth poses by a one-euro filter");
  command->add_option("--predict-ms", flags->predict_ms,
                      "carry poses on over their age and so much more");
  command->add_flag("--json", flags->json, "print one JSON object");
  command->callback([flags] { condition(*flags); });
}
