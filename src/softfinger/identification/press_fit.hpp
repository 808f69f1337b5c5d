#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/identification/finger_fit.hpp"

namespace softfinger {

struct PressFitOptions {
  std::filesystem::path finger;                ///< finger file to start from
  std::filesystem::path curve;                 ///< CSV file: indentation_mm,force_N
  std::optional<std::filesystem::path> areas;  ///< CSV file: force_N,area_mm2
  /// New finger file with what was found; empty: none is written.
  std::optional<std::filesystem::path> out;
  std::vector<std::string> parameters;             ///< by their names in FitInput::parameters
  std::optional<ForceNoise> noise;                 ///< empty: the likelier one
  double angle = 0.0;                              ///< pitch of the finger, distal end down, rad
  std::function<void(int simulations)> simulated;  ///< told after each; may be empty
};

/// Constants of a finger's skin, and what the words of its file call them.
struct PressFit {
  FingerFit fit;
  std::shared_ptr<const FingerModel> model;
  /// An estimate in the unit of the finger file.
  struct Told {
    std::string name;
    double value, low, high;
  };
  std::vector<Told> told;  ///< one an estimate
};

/// Fits a finger file's Young's modulus and strain limits to a press that was measured on a flat
/// plate, by fit_finger(). Throws InputError for data that do not fit each other or the finger, for
/// an unknown parameter, and for an `out` that is there already; OperationError where it cannot be
/// written.
[[nodiscard]] PressFit fit_press(const PressFitOptions& options);

/// The fields of `softfinger finger fit --json`, as text.
[[nodiscard]] std::string press_fit_json(const PressFit& found, const PressFitOptions& options);

/// "95 %: 30.1 to 32.3".
[[nodiscard]] std::string interval_text(const PressFit::Told& told);

}  // namespace softfinger
