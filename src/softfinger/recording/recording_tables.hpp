#pragma once

#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/table.hpp"

namespace softfinger {

/// Writes a recording as tables: pose (tracked), bone, contact, configuration, force, joints,
/// command, timing, messages, objects where some move by the forces on them, and nodes and samples
/// where the whole state was recorded. First column time_s, with several fingers the second
/// `finger`; rows sorted by these. configuration, force, joints and command have a row for each
/// device tick, pose, bone, contact and timing for each step. Throws InputError where the recording
/// is damaged, and what the store throws.
void write_tables(RecordingReader& reader, TableStore& store);

}  // namespace softfinger
