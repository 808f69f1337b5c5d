#include "finger_fit_command.hpp"

#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/press_fit.hpp"

namespace {

using namespace softfinger;

constexpr double kUsualSimulations = 60.0;  // for the progress bar

struct FitFlags {
  std::string finger, data, area, out;
  std::vector<std::string> parameters;
  std::string noise = "likelier";
  double angle_deg = 0.0;
  bool json = false;
};

PressFitOptions options_of(const FitFlags& flags) {
  PressFitOptions options;
  options.finger = flags.finger;
  options.curve = flags.data;
  if (!flags.area.empty()) options.areas = flags.area;
  options.out = flags.out;
  options.parameters = flags.parameters;
  if (flags.noise == "relative") options.noise = ForceNoise::kRelative;
  if (flags.noise == "absolute") options.noise = ForceNoise::kAbsolute;
  options.angle = flags.angle_deg * deg;
  return options;
}

void print(const PressFit& found, const FitFlags& flags) {
  const FingerFit& fit = found.fit;
  for (const PressFit::Told& t : found.told) {
    fmt::print("{:<21} {:<10.5g} {}\n", t.name, t.value, interval_text(t));
  }
  for (const FingerFit::Kept& k : fit.kept) {
    fmt::print("{:<21} kept: {}\n", name_of(k.parameter), k.reason);
  }
  if (fit.noise == ForceNoise::kRelative) {
    fmt::print("noise of the forces   {:.2g} % of the force\n", 100.0 * fit.force_noise);
  } else {
    fmt::print("noise of the forces   {:.2g} N, the same for all\n", fit.force_noise);
  }
  if (!flags.area.empty()) fmt::print("noise of the areas    {:.2g} %\n", 100.0 * fit.area_noise);
  fmt::print("deviation             {:.2g} % of the force, root mean square\n",
             100.0 * fit.force_deviation);
  fmt::print("simulations           {}\n", fit.simulations);
  fmt::print("written to            {}\n", flags.out);
}

void fit(const FitFlags& flags) {
  PressFitOptions options = options_of(flags);
  ProgressBar progress;
  options.simulated = [&](int simulations) {
    progress.show(simulations / (simulations + kUsualSimulations));
  };
  const PressFit found = fit_press(options);
  progress.clear();
  if (flags.json) {
    fmt::print("{}\n", press_fit_json(found, options));
  } else {
    print(found, flags);
  }
}

}  // namespace

void add_finger_fit_command(CLI::App& finger) {
  CLI::App* command = finger.add_subcommand(
      "fit", "Estimate Young's modulus and strain limits from a measured press on a flat plate");
  auto flags = std::make_shared<FitFlags>();
  takes_shipped(
      command->add_option("FINGER", flags->finger,
                          "finger file (TOML) to start from, or the name of a shipped one"),
      Shipped::kFinger)
      ->required();
  command->add_option("--data", flags->data, "CSV file: indentation_mm,force_N")->required();
  command->add_option("--area", flags->area, "CSV file: force_N,area_mm2");
  command->add_option("--out", flags->out, "new finger file; never an existing one")->required();
  command
      ->add_option("--parameters", flags->parameters,
                   "youngs_modulus_kPa,min,max: these and no others; else all that the data tell")
      ->delimiter(',');
  command->add_option("--noise", flags->noise, "of the forces: likelier, relative or absolute")
      ->check(CLI::IsMember({"likelier", "relative", "absolute"}));
  command->add_option("--angle-deg", flags->angle_deg, "pitch of the finger, distal end down");
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { fit(*flags); });
}
