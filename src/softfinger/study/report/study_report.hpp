#pragma once

#include <filesystem>
#include <string>

#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// Writes report.html, one page that needs nothing beside it, and its plots as SVG files into
/// `folder`, which is made if absent; what an earlier report left there is replaced. A front of
/// objectives, or the best so far of one; what each parameter does; which of them matter; the best
/// designs; why others cannot be. Throws OperationError where it cannot be written, InputError
/// where no design is done yet.
void write_study_report(const StudyTable& table, const std::filesystem::path& folder);

/// The part of that page that is worth looking at while a study goes on, as HTML: front or best so
/// far, the best designs, why others cannot be. Empty where no design is done yet.
[[nodiscard]] std::string report_so_far(const StudyTable& table);

}  // namespace softfinger
