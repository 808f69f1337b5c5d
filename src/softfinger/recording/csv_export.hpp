#pragma once

#include <filesystem>
#include <string>

namespace softfinger {

/// Writes a recording as CSV files into `directory`, which is created: pose (tracked; the format of
/// pose files), bone, contact, configuration, joints, command, timing, messages, and nodes and
/// samples where the whole state was recorded. First column time_s, with several fingers the second
/// `finger`; rows sorted by these; units in the headers; a missing value is an empty field.
/// configuration, joints and command have a row for each device tick, the others for each step.
/// Returns a line for people where the recording was cut, else nothing.
/// Throws InputError where the recording is none or one of the files exists already, and
/// OperationError where they cannot be written.
[[nodiscard]] std::string export_csv(const std::filesystem::path& recording,
                                     const std::filesystem::path& directory);

}  // namespace softfinger
