#include "softfinger/recording/recording_layout.hpp"

#include <fmt/format.h>

#include <concepts>
#include <string_view>
#include <vector>

#include "softfinger/recording/record_fields.hpp"

namespace softfinger::recording_layout {
namespace {

constexpr const char* kOtherTables = R"sql(
create table meta(key text primary key, value) without rowid;
create table files(path text primary key, content blob not null) without rowid;
create table fingers(finger integer primary key, name text not null, model text not null,
  device text not null, tracker text not null, configuration_names text not null,
  joints integer not null, device_rate_Hz real not null);
create table moving_objects(object integer primary key, name text not null,
  joint_unit text not null);
create table object_names(object integer primary key, name text not null);
create table messages(number integer primary key, step integer not null, time_s real not null,
  since_start_s real not null, message text not null);
create table states(step integer not null, finger integer not null, nodes blob not null,
  samples blob not null, primary key(step, finger)) without rowid;
create table object_states(step integer not null, object integer not null, nodes blob not null,
  primary key(step, object)) without rowid;
)sql";

// NaN is null, and a blob of doubles may be empty.
const char* sql_type(double) { return "real"; }
const char* sql_type(const Vector3&) { return "real"; }
const char* sql_type(const StoredPose&) { return "real"; }
const char* sql_type(const Configuration&) { return "blob not null"; }
const char* sql_type(Targets<const FormedCommand>) { return "blob not null"; }
const char* sql_type(DeviceState) { return "text not null"; }
const char* sql_type(std::integral auto) { return "integer not null"; }

std::vector<std::string> names(std::string_view columns) {
  std::vector<std::string> result(1);
  for (const char c : columns) {
    if (c == ',') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

/// "create table NAME(COLUMNS, primary key(KEY)) without rowid;". Aliases are generated when they
/// are read and take no room.
template <typename Record, typename Fields>
std::string create(const char* name, Fields fields, const char* key) {
  std::string columns;
  const Record record;
  for_each_field(fields, [&](const auto& field) {
    for (const std::string& column : names(field.use.columns)) {
      columns += fmt::format("{} {}, ", column, sql_type(field.of(record)));
    }
  });
  for_each_field(fields, [&](const auto& field) {
    if (field.use.alias.empty()) return;
    columns += fmt::format("{} blob generated always as ({}) virtual, ", field.use.alias,
                           field.use.columns);
  });
  return fmt::format("create table {}({}primary key({})) without rowid;\n", name, columns, key);
}

template <typename Fields>
std::string insert(const char* table, Fields fields) {
  int columns = 0;
  for_each_field(fields, [&](const auto& field) { columns += column_count(field.use.columns); });
  return insert_into(table, columns);
}

template <typename Fields>
std::string query(Fields fields, const std::set<std::string>& present, const char* rest) {
  std::string columns;
  for_each_field(fields, [&](const auto& field) {
    for (const std::string& column : names(field.use.columns)) {
      if (!columns.empty()) columns += ", ";
      columns += field.use.newer && !present.contains(column) ? "null" : column;
    }
  });
  return fmt::format("select {} from {}", columns, rest);
}

}  // namespace

std::string create_tables() {
  return kOtherTables + create<StepRecord>("steps", kStepFields, "step, finger") +
         create<TickRecord>("ticks", kTickFields, "step, finger, tick") +
         create<ObjectRecord>("objects", kObjectFields, "step, object") +
         create<EventRecord>("events", kEventFields, "step, number") +
         create<FollowRecord>("bones", kFollowFields, "step, object");
}

std::string insert_into(const char* table, int columns) {
  std::string sql = std::string("insert into ") + table + " values (?";
  for (int i = 1; i < columns; ++i) sql += ",?";
  return sql + ")";
}

std::string insert_step() { return insert("steps", kStepFields); }
std::string insert_tick() { return insert("ticks", kTickFields); }
std::string insert_object() { return insert("objects", kObjectFields); }
std::string insert_event() { return insert("events", kEventFields); }
std::string insert_bone() { return insert("bones", kFollowFields); }

std::string step_query(const std::set<std::string>& present) {
  return query(kStepFields, present, "steps order by step, finger");
}
std::string tick_query(const std::set<std::string>& present) {
  return query(kTickFields, present, "ticks order by step, finger, tick");
}
std::string object_query(const std::set<std::string>& present) {
  return query(kObjectFields, present, "objects order by step, object");
}
std::string event_query(const std::set<std::string>& present) {
  return query(kEventFields, present, "events order by step, number");
}
std::string bone_query(const std::set<std::string>& present) {
  return query(kFollowFields, present, "bones order by step, object");
}

}  // namespace softfinger::recording_layout
