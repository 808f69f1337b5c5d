#include "finger_fit_command.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "progress_bar.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/identification/finger_file_text.hpp"
#include "softfinger/identification/finger_fit.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

constexpr const char* kCommonModulus = "material.youngs_modulus_kPa";
constexpr double kUsualSimulations = 60.0;  // for the progress bar

struct FitFlags {
  std::string finger, data, area, out;
  std::vector<std::string> parameters;
  std::string noise = "likelier";
  double angle_deg = 0.0;
  bool json = false;
};

[[noreturn]] void refuse(const std::string& what) { throw InputError("finger fit: " + what); }

FitParameter parameter_of(const std::string& word) {
  std::vector<std::string> names;
  for (const FitParameter p :
       {FitParameter::kYoungsModulus, FitParameter::kMin, FitParameter::kMax}) {
    if (word == name_of(p)) return p;
    names.push_back(name_of(p));
  }
  refuse(fmt::format("--parameters {}: there are {}", word, fmt::join(names, ", ")));
}

/// Before any work: the file must be new and its folder there.
void check_out(const std::string& out) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::symlink_status(out, ignored).type() != fs::file_type::not_found) {
    refuse(fmt::format("--out {}: exists already; name a new file", out));
  }
  const fs::path folder = fs::absolute(out).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    refuse(fmt::format("--out {}: there is no folder {}", out, folder.string()));
  }
}

void write_new(const std::string& out, const std::string& text) {
  std::FILE* file = std::fopen(out.c_str(), "wx");
  if (file == nullptr && errno == EEXIST) {
    refuse(fmt::format("--out {}: exists already; name a new file", out));
  }
  if (file == nullptr) throw OperationError("finger fit: cannot write " + out);
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return;
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  throw OperationError(fmt::format("{}: cannot be written (is there room on the disk?)", out));
}

FitInput read_input(const FitFlags& flags, const FingerModel& model) {
  FitInput input;
  input.curve = read_indentation_curve(flags.data);
  const double pulp = pulp_depth(model);
  for (std::size_t i = 0; i < input.curve.lines.size(); ++i) {
    if (input.curve.first[i] < pulp) continue;
    input.curve.fail(i, fmt::format("indentation_mm: {:.4g} is deeper than the {:.2f} mm of tissue "
                                    "under the bone of {}",
                                    input.curve.first[i] / mm, pulp / mm, flags.finger));
  }
  if (!flags.area.empty()) input.areas = read_contact_areas(flags.area);
  input.has_limits = model.strain_limits.stiffness > 0.0;
  input.width = model.strain_limits.width;
  input.start = {1.0, model.strain_limits.min, model.strain_limits.max};
  for (const std::string& word : flags.parameters) input.parameters.push_back(parameter_of(word));
  if (flags.noise == "relative") input.noise = ForceNoise::kRelative;
  if (flags.noise == "absolute") input.noise = ForceNoise::kAbsolute;
  return input;
}

/// Whether the finger has a modulus for all volumes; else what is fitted is the layers' factor.
bool has_common_modulus(const FingerModel& model) {
  return youngs_moduli(model).front().first == kCommonModulus;
}

/// A parameter's estimate in the unit of the finger file.
struct Told {
  std::string name;
  double value, low, high;
};

Told told(const FingerFit::Estimate& e, const FingerModel& model) {
  if (e.parameter != FitParameter::kYoungsModulus) {
    return {name_of(e.parameter), e.value, e.ci95_low, e.ci95_high};
  }
  if (!has_common_modulus(model)) {
    return {"youngs_modulus_factor", e.value, e.ci95_low, e.ci95_high};
  }
  const double unit = youngs_moduli(model).front().second / kPa;
  return {name_of(e.parameter), e.value * unit, e.ci95_low * unit, e.ci95_high * unit};
}

Json to_json(const FingerFit& fit, const FingerModel& model, const FitFlags& flags) {
  Json parameters = Json::object();
  Json kept = Json::object();
  Json moduli = Json::object();
  for (const FingerFit::Estimate& e : fit.estimates) {
    const Told t = told(e, model);
    parameters[t.name] = {{"value", t.value}, {"ci95_low", t.low}, {"ci95_high", t.high}};
  }
  for (const FingerFit::Kept& k : fit.kept) kept[name_of(k.parameter)] = k.reason;
  for (const auto& [key, value] : youngs_moduli(model)) {
    moduli[key] = value * fit.constants.youngs_modulus_factor / kPa;
  }
  const bool relative = fit.noise == ForceNoise::kRelative;
  return {{"parameters", parameters},
          {"kept", kept},
          {"moduli_kPa", moduli},
          {"noise_model", relative ? "relative" : "absolute"},
          {relative ? "force_noise" : "force_noise_N", fit.force_noise},
          {"area_noise", flags.area.empty() ? Json() : Json(fit.area_noise)},
          {"force_deviation", fit.force_deviation},
          {"degrees_of_freedom", fit.degrees_of_freedom},
          {"simulations", fit.simulations},
          {"out", flags.out}};
}

/// One line for people and for the file: "31.2 (95 %: 30.1 to 32.3)".
std::string interval_text(const Told& t) {
  return fmt::format("95 %: {:.4g} to {:.4g}", t.low, t.high);
}

std::string file_text(const FingerFit& fit, const FingerModel& model, const FitFlags& flags) {
  const auto name = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  std::vector<std::string> head{
      fmt::format("{} with constants fitted by softfinger finger fit to {}{}", name(flags.finger),
                  name(flags.data), flags.area.empty() ? "" : " and " + name(flags.area)),
      fmt::format(
          "(flat press; forces simulated and measured differ by {:.1f} %, root mean square).",
          100.0 * fit.force_deviation)};
  std::map<std::string, std::string> remarks;
  const auto key_of = [](FitParameter p) {
    return (p == FitParameter::kYoungsModulus ? "material." : "strain_limits.") + name_of(p);
  };
  for (const FingerFit::Estimate& e : fit.estimates) {
    const std::string interval = interval_text(told(e, model));
    if (e.parameter != FitParameter::kYoungsModulus) {
      remarks[key_of(e.parameter)] = "fitted; " + interval;
      continue;
    }
    const bool common = has_common_modulus(model);
    if (common) remarks[kCommonModulus] = "fitted; " + interval;
    for (const auto& [key, value] : youngs_moduli(model)) {
      remarks.try_emplace(key, common
                                   ? "scaled with the modulus of [material]"
                                   : fmt::format("fitted, one factor on all layers of {:.4g}; {}",
                                                 e.value, interval));
    }
  }
  for (const FingerFit::Kept& k : fit.kept) {
    remarks[key_of(k.parameter)] = "kept as in " + name(flags.finger);
  }
  return finger_file_text(model, fit.constants, flags.out, head, remarks);
}

void print(const FingerFit& fit, const FingerModel& model, const FitFlags& flags) {
  for (const FingerFit::Estimate& e : fit.estimates) {
    const Told t = told(e, model);
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
  if (!(std::abs(flags.angle_deg) <= 89.0)) {
    refuse(fmt::format("--angle-deg {}: must be from -89 to 89", flags.angle_deg));
  }
  check_out(flags.out);
  const auto model = FingerModel::load(flags.finger);
  const FitInput input = read_input(flags, *model);
  ProgressBar progress;
  double done = 0.0;
  const double depth = input.curve.first.back();
  const PressSimulation simulate = [&](const FingerConstants& constants) {
    auto curve = simulate_press(with_constants(*model, constants), depth, flags.angle_deg * deg);
    done += 1.0;
    progress.show(done / (done + kUsualSimulations));
    return curve;
  };
  const FingerFit result = fit_finger(input, simulate);
  progress.clear();
  write_new(flags.out, file_text(result, *model, flags));
  if (flags.json) {
    fmt::print("{}\n", to_json(result, *model, flags).dump(2));
  } else {
    print(result, *model, flags);
  }
}

}  // namespace

void add_finger_fit_command(CLI::App& finger) {
  CLI::App* command = finger.add_subcommand(
      "fit", "Estimate Young's modulus and strain limits from a measured press on a flat plate");
  auto flags = std::make_shared<FitFlags>();
  command->add_option("FINGER", flags->finger, "finger file (TOML) to start from")->required();
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
