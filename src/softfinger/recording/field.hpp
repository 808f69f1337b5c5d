#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>
#include <tuple>
#include <utility>

#include "softfinger/actuation/actuator.hpp"

namespace softfinger {

/// What first_difference says of a record, in the order in which it looks.
enum class RecordPart {
  kStep,
  kTrackedPose,
  kBonePose,
  kContact,
  kSolution,
  kStepOutcome,
  kTick,
  kMatching,
  kCommand,
  kTickOutcome,
  kObject,
  kNotCompared  ///< clocks and what the hash covers
};
inline constexpr std::array kRecordPartNames = {"step",        "tracked pose",
                                                "bone pose",   "contact",
                                                "solution",    "state, configuration or command",
                                                "device tick", "matching",
                                                "command",     "configuration or command",
                                                "object"};

/// The CSV files that fields of a record go to; see export_csv.
enum class CsvFile {
  kNone,
  kPose,
  kBone,
  kContact,
  kTiming,
  kConfiguration,
  kForce,
  kJoints,
  kCommand,
  kObjects,
  kEvents
};

/// Where a field is in the exported CSV.
template <typename Record>
struct CsvPlace {
  CsvFile file = CsvFile::kNone;
  /// As in the header, with the unit of numbers that are not whole. Empty where the fingers of the
  /// recording say which columns there are.
  std::string_view columns = {};
  /// Columns of a file are sorted by this, then as the tables of fields. Those of timing.csv have
  /// 0 to 2; what is added there has kLastCsvRank, so that it comes last.
  int rank = 0;
  /// Whether the record has a value; null: always. Else the columns are empty.
  bool (*known)(const Record&) = nullptr;
};
inline constexpr int kLastCsvRank = 3;

/// What becomes of a field of a record, apart from where it lies in it.
template <typename Record>
struct FieldUse {
  /// Names of its SQL columns, with commas between.
  std::string_view columns = {};
  RecordPart part = RecordPart::kNotCompared;
  CsvPlace<Record> csv = {};
  /// Its name and unit in what the live page gets; for numbers of ContactSums.
  std::string_view live = {};
  /// A better name for its one SQL column, which keeps the old one too.
  std::string_view alias = {};
  /// There are recordings that lack it: a number or vector, read from them as NaN, which compares
  /// as equal.
  bool newer = false;
};

/// A member of a record, or of a member, and what becomes of it. What can be a field: numbers,
/// flags, Vector3, StoredPose, Configuration, DeviceState and Targets.
template <typename Record, auto... Path>
struct Field {
  FieldUse<Record> use;

  /// The member itself, const where the record is.
  template <typename Object>
  [[nodiscard]] static constexpr decltype(auto) of(Object& record) {
    return reach<Path...>(record);
  }

 private:
  template <auto First, auto... Rest, typename Object>
  static constexpr decltype(auto) reach(Object& object) {
    if constexpr (sizeof...(Rest) == 0) {
      return std::invoke(First, object);
    } else {
      return reach<Rest...>(std::invoke(First, object));
    }
  }
};

/// The part of a command that goes to the servos, as a field of its own.
template <typename Command>
struct Targets {
  Command& command;  ///< const or not
};
struct TargetsOf {
  template <typename Command>
  constexpr Targets<Command> operator()(Command& command) const {
    return {command};
  }
};
inline constexpr TargetsOf kTargets;

/// Calls `visit` with each field of a table, in its order. A table is a type whose `all` is the
/// tuple of them, so that messages of compilers name the type.
template <typename Table, typename Visit>
constexpr void for_each_field(Table, Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, Table::all);
}

/// How many columns a text with commas between them names.
constexpr int column_count(std::string_view columns) {
  return columns.empty() ? 0
                         : 1 + static_cast<int>(std::count(columns.begin(), columns.end(), ','));
}

}  // namespace softfinger
