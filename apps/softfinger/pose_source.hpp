#pragma once

#include <filesystem>
#include <string>

#include "softfinger/tracking/csv_tracker.hpp"

/// The tracked poses of a recording (of the finger of that name; empty: the first) or of a CSV file
/// of poses, to be sampled at any time. Throws softfinger::InputError.
[[nodiscard]] softfinger::CsvTracker read_poses(const std::filesystem::path& file,
                                                const std::string& finger);
