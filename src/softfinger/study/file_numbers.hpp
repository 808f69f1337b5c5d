#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/study/study.hpp"

namespace softfinger {

inline constexpr std::array<NameRow<VariedFile>, 3> kVariedFiles{{
    {VariedFile::kDevice, "device"},
    {VariedFile::kFinger, "finger"},
    {VariedFile::kScene, "scene"},
}};

/// Splits "device.geometry.crank_mm" after the file's name; null where it begins with none.
[[nodiscard]] const NameRow<VariedFile>* file_of(std::string_view key, std::string& way);

/// The numbers of a study's files by their keys, "device.geometry.crank_mm".
class FileNumbers {
 public:
  /// `study` must outlive it, and has its files.
  explicit FileNumbers(Study& study) : study_(study) {}

  /// There is this number in each file it is about, from now on, also where a file leaves it out
  /// and its reader has a default. Empty: there is none.
  std::optional<double> find(VariedFile file, const std::string& way);
  /// The way to a number that may have been meant; empty: none is near.
  [[nodiscard]] std::string nearest(VariedFile file, const std::string& way);
  [[nodiscard]] std::vector<StudyFile*> files(VariedFile file);

 private:
  const std::map<std::string, double>& defaults(VariedFile file);

  Study& study_;
  std::array<std::optional<std::map<std::string, double>>, 3> defaults_;
};

/// What names in formulas stand for: parameters, and all other numbers of the files. Both must
/// outlive it.
[[nodiscard]] Expression::Names names_in(const Study& study, FileNumbers& numbers);

}  // namespace softfinger
