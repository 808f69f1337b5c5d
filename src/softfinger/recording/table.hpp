#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// A column of an exported table.
struct TableColumn {
  std::string name;            ///< with the unit of numbers that are not whole
  bool words = false;          ///< else numbers
  std::size_t most_bytes = 0;  ///< of words whose vocabulary is known; 0: it is not
  std::string unit = {};       ///< of numbers whose name does not say it
};

/// A table that is written row by row, field by field. Throws OperationError where something cannot
/// be written.
class TableWriter {
 public:
  virtual ~TableWriter() = default;

  /// One that is not finite is a missing value.
  virtual void number(double value) = 0;
  virtual void words(std::string_view text) = 0;
  virtual void end_row() = 0;
  /// All rows are there.
  virtual void close() = 0;

  void missing(int numbers) {
    for (int i = 0; i < numbers; ++i) number(std::numeric_limits<double>::quiet_NaN());
  }
};

/// What an export consists of.
class TableStore {
 public:
  virtual ~TableStore() = default;

  /// A new table. Throws InputError where there is one of that name.
  [[nodiscard]] virtual std::unique_ptr<TableWriter> open(
      const std::string& name, const std::vector<TableColumn>& columns) = 0;
};

}  // namespace softfinger
