#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/recording/table.hpp"

namespace softfinger {

/// What the numbers of a study's designs are.
struct StudyHeadings {
  struct Parameter {
    std::string key;
    bool log = false;
    bool tied = false;
  };
  struct Quantity {
    std::string name;
    std::string what;  ///< the measure or formula
    bool objective = true;
    bool maximise = false;
  };
  std::string title;                ///< the study file's name
  std::string kind;                 ///< of its design
  std::string device, device_text;  ///< the device file as the study calls it, and its text
  std::vector<Parameter> parameters;
  std::vector<Quantity> quantities;  ///< objectives first
};

/// A design and what it came to, in the units of the names.
struct StudyRow {
  std::int64_t number = 0;  ///< from 0, in the order of the design
  std::vector<double> parameters;
  std::vector<double> quantities;  ///< NaN where it is not feasible for want of it
  std::string reason;              ///< empty: feasible

  [[nodiscard]] bool feasible() const { return reason.empty(); }
};

struct StudyTable {
  StudyHeadings headings;
  std::vector<StudyRow> rows;  ///< by number; of a study that goes on some may be missing
  bool finished = false;
};

/// Of a study's folder, also while the study goes on. Throws InputError where there is none, or
/// shards alone.
[[nodiscard]] StudyTable read_study_table(const std::filesystem::path& folder);

/// design, parameters, objectives, constraints, feasible, reason; and a row of them for each
/// design.
[[nodiscard]] std::vector<TableColumn> study_columns(const StudyTable& table);
void write_study(const StudyTable& table, TableWriter& writer);

/// Writes that as CSV. Throws
/// InputError where the file exists, OperationError where it cannot be written.
void export_study(const StudyTable& table, const std::filesystem::path& file);

/// Writes the device file of a design: the study's with its numbers in it. Throws InputError where
/// there is no such design yet, or the file exists, OperationError where it cannot be written.
void export_device(const StudyTable& table, std::int64_t design, const std::filesystem::path& file);

}  // namespace softfinger
