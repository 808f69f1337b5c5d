#pragma once

#include <span>
#include <string_view>

#include "softfinger/identification/indentation.hpp"

namespace softfinger {

/// A number of a press by its name in files and output, in the unit of the name.
struct IndentationColumn {
  std::string_view name;  ///< "contact_area_mm2"
  double (*value)(const IndentationRow& row);
  bool whole = false;  ///< counts something
};
/// In the order of `press --csv`.
[[nodiscard]] std::span<const IndentationColumn> indentation_columns();

}  // namespace softfinger
