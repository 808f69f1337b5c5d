#include "softfinger/identification/indentation_columns.hpp"

#include "softfinger/base/units.hpp"

namespace softfinger {

std::span<const IndentationColumn> indentation_columns() {
  using Row = IndentationRow;
  static constexpr IndentationColumn kColumns[] = {
      {"indentation_mm", [](const Row& row) { return row.indentation / mm; }},
      {"normal_force_N", [](const Row& row) { return row.normal_force; }},
      {"tangential_force_N", [](const Row& row) { return row.tangential_force; }},
      {"contact_area_mm2", [](const Row& row) { return row.contact_area / mm2; }},
      {"contact_samples", [](const Row& row) { return double(row.contact_samples); }, true},
      {"max_stretch", [](const Row& row) { return row.max_stretch; }},
      {"min_stretch", [](const Row& row) { return row.min_stretch; }},
      {"volume_ratio", [](const Row& row) { return row.volume_ratio; }},
      {"iterations", [](const Row& row) { return double(row.iterations); }, true},
      {"residual_N", [](const Row& row) { return row.residual; }},
      {"slip_ratio", [](const Row& row) { return row.slip_ratio; }},
      {"stuck_fraction", [](const Row& row) { return row.stuck_fraction; }},
      {"time_s", [](const Row& row) { return row.time; }},
      {"normal_force_sum_N", [](const Row& row) { return row.normal_force_sum; }},
  };
  return kColumns;
}

}  // namespace softfinger
