#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/base/unit_words.hpp"
#include "softfinger/c_interface/handle.hpp"

namespace softfinger {

/// What sf_table holds.
struct Table {
  struct Column {
    std::string name;
    std::vector<double> values;  ///< numbers of words where the unit is empty
    std::string unit = {};       ///< see sf_table_unit()
    std::vector<std::string> words = {};
  };
  std::vector<Column> columns;
  std::string text;  ///< JSON, as the command line has it

  /// Of numbers, in the unit of the name.
  void add_column(std::string_view name) {
    const std::string_view unit = unit_symbol(name);
    columns.push_back(
        {.name = std::string(name), .values = {}, .unit = std::string(unit.empty() ? "1" : unit)});
  }
};

}  // namespace softfinger

struct sf_table : softfinger::Handle<softfinger::Table> {
  using Handle::Handle;
};
