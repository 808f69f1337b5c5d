#pragma once

#include <filesystem>
#include <string>

#include "softfinger/tracking/csv_tracker.hpp"

namespace softfinger {

/// The tracked poses of a recording (of the finger of that name; empty: the first) or of a CSV file
/// of poses, to be sampled at any time. Throws InputError.
[[nodiscard]] CsvTracker read_poses(const std::filesystem::path& file, const std::string& finger);

}  // namespace softfinger
