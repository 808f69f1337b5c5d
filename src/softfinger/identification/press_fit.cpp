#include "softfinger/identification/press_fit.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <map>
#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/finger_file_text.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCommonModulus = "material.youngs_modulus_kPa";

[[noreturn]] void refuse_fit(const std::string& what) { throw InputError("finger fit: " + what); }

FitParameter parameter_of(const std::string& word) {
  std::vector<std::string> names;
  for (const FitParameter p :
       {FitParameter::kYoungsModulus, FitParameter::kMin, FitParameter::kMax}) {
    if (word == name_of(p)) return p;
    names.push_back(name_of(p));
  }
  refuse_fit(fmt::format("--parameters {}: there are {}", word, fmt::join(names, ", ")));
}

/// Before any work: the file must be new and its folder there.
void check_out(const fs::path& out) {
  std::error_code ignored;
  if (fs::symlink_status(out, ignored).type() != fs::file_type::not_found) {
    refuse_fit(fmt::format("--out {}: exists already; name a new file", out.string()));
  }
  const fs::path folder = fs::absolute(out).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    refuse_fit(fmt::format("--out {}: there is no folder {}", out.string(), folder.string()));
  }
}

void write_new(const fs::path& out, const std::string& text) {
  std::FILE* file = std::fopen(out.c_str(), "wx");
  if (file == nullptr && errno == EEXIST) {
    refuse_fit(fmt::format("--out {}: exists already; name a new file", out.string()));
  }
  if (file == nullptr) throw OperationError("finger fit: cannot write " + out.string());
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return;
  std::error_code ignored;
  fs::remove(out, ignored);
  throw OperationError(
      fmt::format("{}: cannot be written (is there room on the disk?)", out.string()));
}

FitInput read_input(const PressFitOptions& options, const FingerModel& model) {
  FitInput input;
  input.curve = read_indentation_curve(options.curve);
  const double pulp = pulp_depth(model);
  for (std::size_t i = 0; i < input.curve.lines.size(); ++i) {
    if (input.curve.first[i] < pulp) continue;
    input.curve.fail(i, fmt::format("indentation_mm: {:.4g} is deeper than the {:.2f} mm of tissue "
                                    "under the bone of {}",
                                    input.curve.first[i] / mm, pulp / mm, options.finger.string()));
  }
  if (options.areas) input.areas = read_contact_areas(*options.areas);
  input.has_limits = model.strain_limits.stiffness > 0.0;
  input.width = model.strain_limits.width;
  input.start = {1.0, model.strain_limits.min, model.strain_limits.max};
  for (const std::string& word : options.parameters) input.parameters.push_back(parameter_of(word));
  input.noise = options.noise;
  return input;
}

/// Whether the finger has a modulus for all volumes; else what is fitted is the layers' factor.
bool has_common_modulus(const FingerModel& model) {
  return youngs_moduli(model).front().first == kCommonModulus;
}

PressFit::Told told_of(const FingerFit::Estimate& e, const FingerModel& model) {
  if (e.parameter != FitParameter::kYoungsModulus) {
    return {name_of(e.parameter), e.value, e.ci95_low, e.ci95_high};
  }
  if (!has_common_modulus(model)) {
    return {"youngs_modulus_factor", e.value, e.ci95_low, e.ci95_high};
  }
  const double unit = youngs_moduli(model).front().second / kPa;
  return {name_of(e.parameter), e.value * unit, e.ci95_low * unit, e.ci95_high * unit};
}

std::string file_text(const PressFit& found, const PressFitOptions& options) {
  const FingerModel& model = *found.model;
  const auto name = [](const fs::path& path) { return path.filename().string(); };
  std::vector<std::string> head{
      fmt::format("{} with constants fitted by softfinger finger fit to {}{}", name(options.finger),
                  name(options.curve), options.areas ? " and " + name(*options.areas) : ""),
      fmt::format(
          "(flat press; forces simulated and measured differ by {:.1f} %, root mean square).",
          100.0 * found.fit.force_deviation)};
  std::map<std::string, std::string> remarks;
  const auto key_of = [](FitParameter p) {
    return (p == FitParameter::kYoungsModulus ? "material." : "strain_limits.") + name_of(p);
  };
  for (std::size_t i = 0; i < found.told.size(); ++i) {
    const FingerFit::Estimate& e = found.fit.estimates[i];
    const std::string interval = interval_text(found.told[i]);
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
  for (const FingerFit::Kept& k : found.fit.kept) {
    remarks[key_of(k.parameter)] = "kept as in " + name(options.finger);
  }
  return finger_file_text(model, found.fit.constants, *options.out, head, remarks);
}

}  // namespace

std::string interval_text(const PressFit::Told& told) {
  return fmt::format("95 %: {:.4g} to {:.4g}", told.low, told.high);
}

PressFit fit_press(const PressFitOptions& options) {
  if (!(std::abs(options.angle) <= 89.0 * deg)) {
    refuse_fit(fmt::format("--angle-deg {:.10g}: must be from -89 to 89", options.angle / deg));
  }
  if (options.out) check_out(*options.out);
  PressFit found;
  found.model = FingerModel::load(options.finger);
  const FitInput input = read_input(options, *found.model);
  const double depth = input.curve.first.back();
  int simulations = 0;
  found.fit = fit_finger(input, [&](const FingerConstants& constants) {
    auto curve = simulate_press(with_constants(*found.model, constants), depth, options.angle);
    if (options.simulated) options.simulated(++simulations);
    return curve;
  });
  for (const FingerFit::Estimate& e : found.fit.estimates) {
    found.told.push_back(told_of(e, *found.model));
  }
  if (options.out) write_new(*options.out, file_text(found, options));
  return found;
}

}  // namespace softfinger
