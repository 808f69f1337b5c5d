#pragma once

#include <string>

namespace softfinger::recording_layout {

// The tables of a recording, shared by writer and reader. SI units throughout.

/// "SFrc", read by PRAGMA application_id.
inline constexpr int kApplicationId = 0x53467263;

inline constexpr const char* kTables = R"sql(
create table meta(key text primary key, value) without rowid;
create table files(path text primary key, content blob not null) without rowid;
create table fingers(finger integer primary key, name text not null, model text not null,
  device text not null, tracker text not null, configuration_names text not null,
  joints integer not null, device_rate_Hz real not null);
create table steps(step integer not null, finger integer not null, time_s real not null,
  x_m real, y_m real, z_m real, qw real, qx real, qy real, qz real,
  tracked_time_s real, valid integer not null,
  bone_x_m real, bone_y_m real, bone_z_m real, bone_qw real, bone_qx real, bone_qy real,
  bone_qz real,
  contact_samples integer not null, contact_area_m2 real, normal_force_N real,
  tangential_force_N real, slip_ratio real, stuck_fraction real, centroid_x_m real, centroid_y_m real, centroid_z_m real,
  normal_x real, normal_y real, normal_z real, least_gap_m real,
  iterations integer not null, converged integer not null, residual real,
  tick integer not null, hash integer not null, cpu_s real, wall_s real,
  normal_force_sum_N real,
  primary key(step, finger)) without rowid;
create table ticks(step integer not null, finger integer not null, tick integer not null,
  time_s real not null, tracked integer not null, emergency integer not null,
  measured_force_N real, measured_at blob not null,
  wanted blob not null, deviation_m2 real, iterations integer not null,
  travel_offset_m real, ceiling real,
  configuration blob not null, joints_rad blob not null, servo_us blob not null,
  state text not null, hash integer not null, cpu_s real, latency_s real,
  primary key(step, finger, tick)) without rowid;
create table states(step integer not null, finger integer not null, nodes blob not null,
  samples blob not null, primary key(step, finger)) without rowid;
)sql";

/// Keys of `meta` that name a mesh file after it; the value is its content's hash in hexadecimal.
inline const std::string kMeshKey = "mesh:";

/// Keys of `meta` that name the number of a finger whose device's joints are lengths, in m though
/// the column is called joints_rad.
inline const std::string kLinearJointsKey = "linear_joints:";

/// Keys of `meta` that name the number of a finger whose set points are not in quarters of a
/// microsecond, though the column is called servo_us: their unit, and one step of the wire in it.
inline const std::string kServoUnitKey = "servo_unit:";
inline const std::string kServoStepKey = "servo_step:";

inline constexpr int kStepColumns = 40;
inline constexpr int kTickColumns = 20;

/// "insert into TABLE values (?,?,...)".
inline std::string insert_into(const char* table, int columns) {
  std::string sql = std::string("insert into ") + table + " values (?";
  for (int i = 1; i < columns; ++i) sql += ",?";
  return sql + ")";
}

}  // namespace softfinger::recording_layout
