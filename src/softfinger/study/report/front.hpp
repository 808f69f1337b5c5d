#pragma once

#include <cstddef>
#include <vector>

#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// Rows of feasible designs that no other feasible one is better than in one objective and no worse
/// in the others, by the first objective; of several that came to the same, the first.
[[nodiscard]] std::vector<std::size_t> front_of(const StudyTable& table);

/// Number of objectives among the quantities.
[[nodiscard]] std::size_t objective_count(const StudyHeadings& headings);

}  // namespace softfinger
