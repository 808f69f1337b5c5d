#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/c_interface/handle.hpp"

namespace softfinger {

/// What sf_table holds.
struct Table {
  struct Column {
    std::string name;
    std::vector<double> values;
  };
  std::vector<Column> columns;
  std::string text;  ///< JSON, as the command line has it

  void add_column(std::string_view name) { columns.push_back({std::string(name), {}}); }
};

}  // namespace softfinger

struct sf_table : softfinger::Handle<softfinger::Table> {
  using Handle::Handle;
};
