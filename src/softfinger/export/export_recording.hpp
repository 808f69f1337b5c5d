#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace softfinger {

/// Writes a recording as what `to` ends in: .h5 an HDF5 file, .mcap an MCAP file, nothing a folder
/// of CSV files. A file comes into being as a whole or not at all. Returns a line for people: where
/// the recording was cut, what it did not allow; else nothing.
/// Throws InputError where the recording is none, `to` exists already (a folder may) or ends in
/// something else, and OperationError where it cannot be written. `progress` gets how much of a
/// pass over the recording is done, 0 to 1, of which CSV and HDF5 take several; what it throws ends
/// the export, and nothing is left of it.
[[nodiscard]] std::string export_recording(const std::filesystem::path& recording,
                                           const std::filesystem::path& to,
                                           const std::function<void(double)>& progress = {});

}  // namespace softfinger
