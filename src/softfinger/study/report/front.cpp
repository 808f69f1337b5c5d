#include "softfinger/study/report/front.hpp"

#include <algorithm>

namespace softfinger {
namespace {

/// Less is better in all of them.
std::vector<double> objectives_of(const StudyTable& table, std::size_t row) {
  std::vector<double> values;
  for (std::size_t k = 0; k < objective_count(table.headings); ++k) {
    const double value = table.rows[row].quantities[k];
    values.push_back(table.headings.quantities[k].maximise ? -value : value);
  }
  return values;
}

bool is_no_worse(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] > b[k]) return false;
  }
  return true;
}

}  // namespace

std::size_t objective_count(const StudyHeadings& headings) {
  return static_cast<std::size_t>(
      std::ranges::count_if(headings.quantities, &StudyHeadings::Quantity::objective));
}

std::vector<std::size_t> front_of(const StudyTable& table) {
  std::vector<std::pair<std::vector<double>, std::size_t>> designs;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (table.rows[row].feasible()) designs.emplace_back(objectives_of(table, row), row);
  }
  // Nothing after a design in this order is better than it in the first objective.
  std::ranges::sort(designs);
  std::vector<std::pair<std::vector<double>, std::size_t>> front;
  for (const auto& design : designs) {
    const auto better = [&](const auto& one) { return is_no_worse(one.first, design.first); };
    if (std::ranges::none_of(front, better)) front.push_back(design);
  }
  std::vector<std::size_t> rows;
  rows.reserve(front.size());
  for (const auto& [objectives, row] : front) rows.push_back(row);
  return rows;
}

}  // namespace softfinger
