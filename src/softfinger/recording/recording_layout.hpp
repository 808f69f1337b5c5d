#pragma once

#include <set>
#include <string>

namespace softfinger::recording_layout {

// The tables of a recording, shared by writer and reader. SI units throughout. The columns of steps
// and ticks are those of record_fields.hpp, in its order.

/// "SFrc", read by PRAGMA application_id.
inline constexpr int kApplicationId = 0x53467263;

/// Keys of `meta` that name a mesh file after it; the value is its content's hash in hexadecimal.
inline const std::string kMeshKey = "mesh:";

/// Keys of `meta` that name the number of a finger whose device's joints are lengths, in m.
inline const std::string kLinearJointsKey = "linear_joints:";

/// Keys of `meta` that name the number of a finger to whose tracked poses something was done: what.
inline const std::string kPosesKey = "poses:";

/// Keys of `meta` that name the number of a finger whose set points are not in quarters of a
/// microsecond: their unit, and one step of the wire in it.
inline const std::string kServoUnitKey = "servo_unit:";
inline const std::string kServoStepKey = "servo_step:";

/// Where step_query and tick_query have the number of the finger.
inline constexpr int kFingerColumn = 1;
/// Where object_query has that of the object.
inline constexpr int kObjectColumn = 1;

/// SQL that makes every table.
[[nodiscard]] std::string create_tables();

/// "insert into TABLE values (?,?,...)".
[[nodiscard]] std::string insert_into(const char* table, int columns);
/// A row of steps, a row of ticks, with a parameter for each column.
[[nodiscard]] std::string insert_step();
[[nodiscard]] std::string insert_tick();
[[nodiscard]] std::string insert_object();
[[nodiscard]] std::string insert_event();
[[nodiscard]] std::string insert_bone();

/// All rows of steps, of ticks, in order. `present` are the columns that the recording has: what
/// may be lacking (FieldUse::newer) is null then.
[[nodiscard]] std::string step_query(const std::set<std::string>& present);
[[nodiscard]] std::string tick_query(const std::set<std::string>& present);
[[nodiscard]] std::string object_query(const std::set<std::string>& present);
[[nodiscard]] std::string event_query(const std::set<std::string>& present);
[[nodiscard]] std::string bone_query(const std::set<std::string>& present);

}  // namespace softfinger::recording_layout
