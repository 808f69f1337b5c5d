#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/files/toml_text.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/study/measure.hpp"
#include "softfinger/study/parameter.hpp"
#include "softfinger/study/population.hpp"

namespace softfinger {

/// How designs are chosen.
enum class DesignKind { kGrid, kLhs, kSobol, kNsga2, kGaco };
struct DesignKindRow {
  DesignKind value;
  std::string_view name;
  bool searches;  ///< which designs come next follows from what those before came to
};
inline constexpr std::array<DesignKindRow, 5> kDesignKinds{{
    {DesignKind::kGrid, "grid", false},
    {DesignKind::kLhs, "lhs", false},
    {DesignKind::kSobol, "sobol", false},
    {DesignKind::kNsga2, "nsga2", true},
    {DesignKind::kGaco, "gaco", true},
}};

/// `[design]`.
struct DesignPlan {
  DesignKind kind = DesignKind::kGrid;
  std::uint32_t seed = 1;
  std::size_t size = 0;         ///< designs, or those of a generation; of a grid: all of it
  std::size_t generations = 0;  ///< after the first; 0 where nothing is searched
};

/// What a design is judged by: an objective, or what a constraint bounds. One number a design, in
/// the unit of the measure's name.
struct Quantity {
  std::string name;
  std::string measure;                        ///< see measure_words(); empty: a formula
  std::shared_ptr<const Expression> formula;  ///< of the design; null: measured
  Over over_frames = Over::kMean;
  Over over_people = Over::kMean;
  bool maximise = false;                    ///< more is better
  std::optional<double> at_least, at_most;  ///< of a constraint
};

/// A file that a study reads, and in which numbers may differ.
struct StudyFile {
  std::filesystem::path path;
  std::string written;  ///< in the study
  TomlText text;
};

/// A study file as read, with the texts of what it names.
struct Study {
  std::filesystem::path file;
  std::string text;
  std::vector<StudyFile> scenes;    ///< none: nothing is touched, and the device alone is read
  std::optional<StudyFile> finger;  ///< of all scenes; empty without one
  StudyFile device;
  const ObjectiveKind* objective = nullptr;  ///< null: the device file's
  std::vector<Parameter> parameters;
  std::vector<Quantity> objectives, constraints;
  Population population;
  DesignPlan plan;

  /// Objectives, then constraints.
  [[nodiscard]] std::vector<const Quantity*> quantities() const;
  /// The measures of all of them.
  [[nodiscard]] std::vector<std::string> measures() const;
};

/// Reads a study file (TOML, keys in docs/files.md) and the files that it names. Throws InputError
/// with file, line and key.
[[nodiscard]] Study load_study(const std::filesystem::path& file);

}  // namespace softfinger
