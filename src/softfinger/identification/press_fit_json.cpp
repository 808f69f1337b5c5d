#include <nlohmann/json.hpp>

#include "softfinger/base/units.hpp"
#include "softfinger/identification/finger_file_text.hpp"
#include "softfinger/identification/press_fit.hpp"

namespace softfinger {

std::string press_fit_json(const PressFit& found, const PressFitOptions& options) {
  using Fields = nlohmann::ordered_json;
  const FingerFit& fit = found.fit;
  Fields parameters = Fields::object();
  Fields kept = Fields::object();
  Fields moduli = Fields::object();
  for (const PressFit::Told& t : found.told) {
    parameters[t.name] = {{"value", t.value}, {"ci95_low", t.low}, {"ci95_high", t.high}};
  }
  for (const FingerFit::Kept& k : fit.kept) kept[name_of(k.parameter)] = k.reason;
  for (const auto& [key, value] : youngs_moduli(*found.model)) {
    moduli[key] = value * fit.constants.youngs_modulus_factor / kPa;
  }
  const bool relative = fit.noise == ForceNoise::kRelative;
  const Fields report = {{"parameters", parameters},
                         {"kept", kept},
                         {"moduli_kPa", moduli},
                         {"noise_model", relative ? "relative" : "absolute"},
                         {relative ? "force_noise" : "force_noise_N", fit.force_noise},
                         {"area_noise", options.areas ? Fields(fit.area_noise) : Fields()},
                         {"force_deviation", fit.force_deviation},
                         {"degrees_of_freedom", fit.degrees_of_freedom},
                         {"simulations", fit.simulations},
                         {"out", options.out ? Fields(options.out->string()) : Fields()}};
  return report.dump(2);
}

}  // namespace softfinger
