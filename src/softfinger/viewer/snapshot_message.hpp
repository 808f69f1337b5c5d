#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

inline constexpr std::uint32_t kSnapshotMagic = 0x41534653;  ///< "SFSA"

/// Writes a snapshot as docs/protocol.md has it and clients read it
/// (clients/javascript/src/wire.js). `scene` gives the units of the configuration; it must be the
/// one of the snapshot's generation.
///
/// Layout, little-endian, every number 4 bytes and aligned unless said:
///
///     u32 magic "SFSA"        u32 generation (low bits)
///     u32 step (low bits)     u32 flags: 1 paused, 2 finished, 4 to be stopped, 8 stopped
///     f64 time_s
///     f32 step_ms             f32 match_ms
///     u32 deadline_misses     u32 objects         u32 fingers
///     u32 wall_ms (low bits), of a clock of any origin
///     u32 stops: how often devices were stopped so far
///     u32 soft objects
///     per object: pose X_WO
///     per finger:
///       pose X_WFt, pose X_WF, pose X_FP
///       f32 each of for_each_live_field, which clients know as kContactSums
///       f32 deviation_mm2
///       u32 tick (low bits)   f32 stages_ms[6] of that tick, see LatencyStage; NaN: unknown
///       f32 device_said_ms: how long ago who leads the servos last showed life; NaN: nobody does
///       u32 samples n         u32 configuration m       u32 joints j           u32 points l
///       u32 pieces k          u32 samples t of the twin; 0: not pressed
///       u32 actual a: m, or 0 where the servos do not say where they are
///       u32 flags of the device: 1 held back by its limit of force;
///           from 256 on the place of what leads it among the scene's objectives
///       16 bytes device_state, zero-padded
///       f32 positions_mm[3 n] in F    f32 pressures_kPa[n]    u8 in_contact[n], zero-padded to 4
///       f32 configuration[m], f32 actual[a] in the units of their names
///       f32 joints[j] in the scene's joint_unit
///       f32 linkage_mm[3 l] in F
///       f32 pieces[8 k]: pose X_FS, radius_mm of a ball, else 0
///       where t > 0, NaN for what is not defined:
///         f32 iou             f32 centroid_shift_mm     f32 normal_angle_deg
///         f32 normal_force_error                        f32 normal_force_bias
///         f32 normal_force_N  f32 contact_area_mm2      f32 press_ms
///         f32 normal_force_sum_N                        f32 tangential_force_N
///         f32 tangential_force_error                    f32 slip_ratio_error
///         f32 positions_mm[3 t] in F  f32 pressures_kPa[t]  u8 in_contact[t], zero-padded to 4
///     per soft object:
///       u32 object: its place among objects           u32 points p
///       f32 positions_mm[3 p] in O
///     pose: f32 x_mm, y_mm, z_mm, quaternion x, y, z, w
void write_snapshot_message(const Snapshot& snapshot, const SceneDescription& scene,
                            std::vector<std::byte>& message);

}  // namespace softfinger
