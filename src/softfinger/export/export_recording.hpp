#pragma once

#include <filesystem>
#include <string>

namespace softfinger {

/// Writes a recording as what `to` ends in: .h5 an HDF5 file, .mcap an MCAP file, nothing a folder
/// of CSV files. A file comes into being as a whole or not at all. Returns a line for people: where
/// the recording was cut, what it did not allow; else nothing.
/// Throws InputError where the recording is none, `to` exists already (a folder may) or ends in
/// something else, and OperationError where it cannot be written.
[[nodiscard]] std::string export_recording(const std::filesystem::path& recording,
                                           const std::filesystem::path& to);

}  // namespace softfinger
