#pragma once

#include "softfinger/export/exported.hpp"
#include "softfinger/files/file_beside.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {

/// Writes a recording as an MCAP file of ROS 2 messages, times from the start of the run; of finger
/// NAME the frames NAME (F), NAME_tracked (Ft) and NAME_platform (P, as commanded), joints
/// NAME_joint_1, ...:
///   /tf      world to F and, unless tracking is lost, Ft in each step; F to P in each tick; world
///            to object_NAME in each step, of each object that moves by forces
///   /wrench  each step, in F: the force on the finger, and its moment about F's origin as if it
///            acted at the centroid of the contact
///   /joints  each tick, where there are devices; each step of object_NAME, where it has a slider
///            or hinge
///   /skin    each step, in F, where the whole state was recorded: see skin_pressures()
///   /events  what people were told, and what happened to objects: "impact: cube and table, 0.012 N
///   s"
/// and recording_facts() as metadata. Throws InputError where the recording is damaged.
[[nodiscard]] Exported export_mcap(RecordingReader& reader, FileBeside& file);

}  // namespace softfinger
