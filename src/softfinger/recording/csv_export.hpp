#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace softfinger {

/// Writes a recording as CSV files into `directory`, which is created: a file for each table of
/// write_tables(), of which pose.csv is a file of poses; units in the headers; a missing value is
/// an empty field. Returns a line for people where the recording was cut, else nothing. Throws
/// InputError where the recording is none or one of the files exists already, and OperationError
/// where they cannot be written; then it leaves none of them. `progress`: see
/// RecordingReader::watch().
[[nodiscard]] std::string export_csv(const std::filesystem::path& recording,
                                     const std::filesystem::path& directory,
                                     const std::function<void(double)>& progress = {});

}  // namespace softfinger
