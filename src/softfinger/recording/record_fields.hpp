#pragma once

#include <string_view>
#include <type_traits>

#include "softfinger/base/units.hpp"
#include "softfinger/recording/field.hpp"
#include "softfinger/recording/record.hpp"

namespace softfinger {

// Every field of a record that a recording holds. The SQL tables, what is written and read, how
// two records are compared and the exported CSV follow from these two tables. A new field is a new
// row at the end, with `newer`: its columns come last, and recordings that lack them stay readable.

template <auto... Path>
constexpr Field<StepRecord, Path...> step_field(const FieldUse<StepRecord>& use) {
  return {use};
}

struct StepFields {
  static constexpr std::tuple all{
      step_field<&StepRecord::step>({.columns = "step", .part = RecordPart::kStep}),
      step_field<&StepRecord::finger>({.columns = "finger", .part = RecordPart::kStep}),
      step_field<&StepRecord::time>({.columns = "time_s"}),
      step_field<&StepRecord::tracked, &TrackedInput::X_WFt>(
          {.columns = "x_m,y_m,z_m,qw,qx,qy,qz",
           .part = RecordPart::kTrackedPose,
           .csv = {.file = CsvFile::kPose,
                   .columns = "x_mm,y_mm,z_mm,qw,qx,qy,qz",
                   .known = [](const StepRecord& step) { return step.tracked.valid; }}}),
      step_field<&StepRecord::tracked, &TrackedInput::time>({.columns = "tracked_time_s"}),
      step_field<&StepRecord::tracked, &TrackedInput::valid>(
          {.columns = "valid", .part = RecordPart::kTrackedPose}),
      step_field<&StepRecord::X_WF>(
          {.columns = "bone_x_m,bone_y_m,bone_z_m,bone_qw,bone_qx,bone_qy,bone_qz",
           .part = RecordPart::kBonePose,
           .csv = {CsvFile::kBone, "x_mm,y_mm,z_mm,qw,qx,qy,qz"}}),
      step_field<&StepRecord::contact_count>({.columns = "contact_samples",
                                              .part = RecordPart::kContact,
                                              .csv = {CsvFile::kContact, "contact_samples"}}),
      step_field<&StepRecord::contact_area>({.columns = "contact_area_m2",
                                             .part = RecordPart::kContact,
                                             .csv = {CsvFile::kContact, "contact_area_mm2"},
                                             .live = "contact_area_mm2"}),
      step_field<&StepRecord::normal_force>({.columns = "normal_force_N",
                                             .part = RecordPart::kContact,
                                             .csv = {CsvFile::kContact, "normal_force_N"},
                                             .live = "normal_force_N"}),
      step_field<&StepRecord::tangential_force>({.columns = "tangential_force_N",
                                                 .part = RecordPart::kContact,
                                                 .csv = {CsvFile::kContact, "tangential_force_N"},
                                                 .live = "tangential_force_N"}),
      step_field<&StepRecord::slip_ratio>({.columns = "slip_ratio",
                                           .part = RecordPart::kContact,
                                           .csv = {CsvFile::kContact, "slip_ratio"},
                                           .live = "slip_ratio"}),
      step_field<&StepRecord::stuck_fraction>({.columns = "stuck_fraction",
                                               .part = RecordPart::kContact,
                                               .csv = {CsvFile::kContact, "stuck_fraction"},
                                               .live = "stuck_fraction"}),
      step_field<&StepRecord::centroid_F>(
          {.columns = "centroid_x_m,centroid_y_m,centroid_z_m",
           .part = RecordPart::kContact,
           .csv = {.file = CsvFile::kContact,
                   .columns = "centroid_x_mm,centroid_y_mm,centroid_z_mm",
                   .known = [](const StepRecord& step) { return step.contact_count > 0; }}}),
      step_field<&StepRecord::mean_normal_F>(
          {.columns = "normal_x,normal_y,normal_z",
           .part = RecordPart::kContact,
           .csv = {.file = CsvFile::kContact,
                   .columns = "normal_x,normal_y,normal_z",
                   .known = [](const StepRecord& step) { return step.contact_count > 0; }}}),
      step_field<&StepRecord::least_gap>({.columns = "least_gap_m",
                                          .part = RecordPart::kContact,
                                          .csv = {CsvFile::kContact, "least_gap_mm"}}),
      step_field<&StepRecord::iterations>({.columns = "iterations",
                                           .part = RecordPart::kSolution,
                                           .csv = {CsvFile::kTiming, "iterations", 1}}),
      step_field<&StepRecord::converged>({.columns = "converged",
                                          .part = RecordPart::kSolution,
                                          .csv = {CsvFile::kTiming, "converged", 1}}),
      step_field<&StepRecord::residual>({.columns = "residual",
                                         .part = RecordPart::kSolution,
                                         .csv = {CsvFile::kTiming, "residual", 1}}),
      step_field<&StepRecord::tick>({.columns = "tick"}),
      step_field<&StepRecord::hash>({.columns = "hash", .part = RecordPart::kStepOutcome}),
      step_field<&StepRecord::cpu_time>({.columns = "cpu_s", .csv = {CsvFile::kTiming, "step_ms"}}),
      step_field<&StepRecord::wall_time>(
          {.columns = "wall_s", .csv = {CsvFile::kTiming, "step_wall_ms"}}),
      step_field<&StepRecord::normal_force_sum>({.columns = "normal_force_sum_N",
                                                 .part = RecordPart::kContact,
                                                 .csv = {CsvFile::kContact, "normal_force_sum_N"},
                                                 .live = "normal_force_sum_N",
                                                 .newer = true}),
      step_field<&StepRecord::tangential_force_F>(
          {.columns = "tangential_x_N,tangential_y_N,tangential_z_N",
           .part = RecordPart::kContact,
           .csv = {CsvFile::kContact, "tangential_x_N,tangential_y_N,tangential_z_N"},
           .newer = true}),
  };
};
inline constexpr StepFields kStepFields;

/// Calls `visit` with name and value of each field of a contact that the live page gets, the value
/// in the unit of the name.
template <typename Visit>
void for_each_live_field(const ContactSums& sums, Visit&& visit) {
  for_each_field(
      kStepFields, [&]<auto... Path>(const Field<StepRecord, Path...>& field) {
        if constexpr ((std::is_same_v<decltype(Path), double ContactSums::*> && ...)) {
          const std::string_view name = field.use.live;
          if (!name.empty()) visit(name, field.of(sums) / unit_scale(name));
        }
      });
}

template <auto... Path>
constexpr Field<TickRecord, Path...> tick_field(const FieldUse<TickRecord>& use) {
  return {use};
}

struct TickFields {
  static constexpr std::tuple all{
      tick_field<&TickRecord::step>({.columns = "step", .part = RecordPart::kTick}),
      tick_field<&TickRecord::finger>({.columns = "finger", .part = RecordPart::kTick}),
      tick_field<&TickRecord::tick>({.columns = "tick", .part = RecordPart::kTick}),
      tick_field<&TickRecord::time>({.columns = "time_s"}),
      tick_field<&TickRecord::tracked>({.columns = "tracked", .part = RecordPart::kTick}),
      tick_field<&TickRecord::emergency>({.columns = "emergency", .part = RecordPart::kTick}),
      tick_field<&TickRecord::reading, &ForceReading::normal_force>(
          {.columns = "measured_force_N",
           .part = RecordPart::kTick,
           .csv = {.file = CsvFile::kForce,
                   .columns = "measured_force_N",
                   .known =
                       [](const TickRecord& t) { return t.reading.configuration.size() > 0; }}}),
      tick_field<&TickRecord::reading, &ForceReading::configuration>(
          {.columns = "measured_at", .part = RecordPart::kTick}),
      tick_field<&TickRecord::wanted>(
          {.columns = "wanted", .part = RecordPart::kMatching, .csv = {CsvFile::kConfiguration}}),
      tick_field<&TickRecord::deviation>({.columns = "deviation_m2",
                                          .part = RecordPart::kMatching,
                                          .csv = {CsvFile::kConfiguration, "deviation_mm2"}}),
      tick_field<&TickRecord::iterations>({.columns = "iterations", .part = RecordPart::kMatching}),
      tick_field<&TickRecord::travel_offset>({.columns = "travel_offset_m",
                                              .part = RecordPart::kMatching,
                                              .csv = {CsvFile::kForce, "travel_offset_mm"}}),
      tick_field<&TickRecord::command, &FormedCommand::ceiling>(
          {.columns = "ceiling", .csv = {CsvFile::kForce, "travel_ceiling_mm"}}),
      tick_field<&TickRecord::command, &FormedCommand::configuration>(
          {.columns = "configuration",
           .part = RecordPart::kCommand,
           .csv = {CsvFile::kConfiguration}}),
      tick_field<&TickRecord::command, &FormedCommand::joints>({.columns = "joints_rad",
                                                                .part = RecordPart::kCommand,
                                                                .csv = {CsvFile::kJoints},
                                                                .alias = "joints"}),
      tick_field<&TickRecord::command, kTargets>({.columns = "servo_us",
                                                  .part = RecordPart::kCommand,
                                                  .csv = {CsvFile::kCommand},
                                                  .alias = "set_points"}),
      tick_field<&TickRecord::command, &FormedCommand::state>(
          {.columns = "state", .part = RecordPart::kCommand, .csv = {CsvFile::kCommand, "state"}}),
      tick_field<&TickRecord::hash>({.columns = "hash", .part = RecordPart::kTickOutcome}),
      tick_field<&TickRecord::cpu_time>(
          {.columns = "cpu_s", .csv = {CsvFile::kTiming, "match_ms", 2}}),
      tick_field<&TickRecord::latency>(
          {.columns = "latency_s", .csv = {CsvFile::kTiming, "latency_ms", 2}}),
      tick_field<&TickRecord::objective>(
          {.columns = "objective", .part = RecordPart::kTick, .newer = true}),
  };
};
inline constexpr TickFields kTickFields;

template <auto... Path>
constexpr Field<ObjectRecord, Path...> object_field(const FieldUse<ObjectRecord>& use) {
  return {use};
}

struct ObjectFields {
  static constexpr std::tuple all{
      object_field<&ObjectRecord::step>({.columns = "step", .part = RecordPart::kObject}),
      object_field<&ObjectRecord::object>({.columns = "object", .part = RecordPart::kObject}),
      object_field<&ObjectRecord::time>({.columns = "time_s"}),
      object_field<&ObjectRecord::X_WO>({.columns = "x_m,y_m,z_m,qw,qx,qy,qz",
                                         .part = RecordPart::kObject,
                                         .csv = {CsvFile::kObjects, "x_mm,y_mm,z_mm,qw,qx,qy,qz"}}),
      object_field<&ObjectRecord::velocity>(
          {.columns = "vx_m_per_s,vy_m_per_s,vz_m_per_s",
           .part = RecordPart::kObject,
           .csv = {CsvFile::kObjects, "vx_mm_per_s,vy_mm_per_s,vz_mm_per_s"}}),
      object_field<&ObjectRecord::angular_velocity>(
          {.columns = "wx_rad_per_s,wy_rad_per_s,wz_rad_per_s",
           .part = RecordPart::kObject,
           .csv = {CsvFile::kObjects, "wx_deg_per_s,wy_deg_per_s,wz_deg_per_s"}}),
      object_field<&ObjectRecord::joint>({.columns = "joint", .part = RecordPart::kObject}),
  };
};
inline constexpr ObjectFields kObjectFields;

template <auto... Path>
constexpr Field<FollowRecord, Path...> follow_field(const FieldUse<FollowRecord>& use) {
  return {use};
}

struct FollowFields {
  static constexpr std::tuple all{
      follow_field<&FollowRecord::step>({.columns = "step", .part = RecordPart::kObject}),
      follow_field<&FollowRecord::object>({.columns = "object", .part = RecordPart::kObject}),
      follow_field<&FollowRecord::X_WT>(
          {.columns = "x_m,y_m,z_m,qw,qx,qy,qz", .part = RecordPart::kObject}),
      follow_field<&FollowRecord::valid>({.columns = "valid", .part = RecordPart::kObject}),
  };
};
inline constexpr FollowFields kFollowFields;

template <auto... Path>
constexpr Field<EventRecord, Path...> event_field(const FieldUse<EventRecord>& use) {
  return {use};
}

struct EventFields {
  static constexpr std::tuple all{
      event_field<&EventRecord::step>({.columns = "step", .part = RecordPart::kObject}),
      event_field<&EventRecord::number>({.columns = "number", .part = RecordPart::kObject}),
      event_field<&EventRecord::time>({.columns = "time_s", .part = RecordPart::kObject}),
      event_field<&EventRecord::kind>({.columns = "kind", .part = RecordPart::kObject}),
      event_field<&EventRecord::object>({.columns = "object", .part = RecordPart::kObject}),
      event_field<&EventRecord::other>({.columns = "other", .part = RecordPart::kObject}),
      event_field<&EventRecord::impulse>({.columns = "impulse_N_s",
                                          .part = RecordPart::kObject,
                                          .csv = {CsvFile::kEvents, "impulse_N_s"}}),
  };
};
inline constexpr EventFields kEventFields;

}  // namespace softfinger
