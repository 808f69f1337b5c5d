#pragma once

#include "softfinger/export/exported.hpp"
#include "softfinger/files/file_beside.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {

/// Writes a recording as an HDF5 file: a group for each table of write_tables() with a data set for
/// each column, its unit in the attribute `unit` ("1": a pure number; empty: words); numbers are
/// 64-bit floats, a missing one NaN; recording_facts() as attributes of the file. One at a time:
/// others wait. Throws InputError where the recording
/// is damaged.
[[nodiscard]] Exported export_hdf5(RecordingReader& reader, FileBeside& file);

}  // namespace softfinger
