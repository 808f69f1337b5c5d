#include "softfinger/recording/recording_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "softfinger/base/error.hpp"
#include "softfinger/recording/record_fields.hpp"
#include "softfinger/recording/recording_layout.hpp"
#include "softfinger/recording/sqlite_database.hpp"

namespace softfinger {
namespace {

/// Targets are 32 bits.
constexpr double kMostSteps = 2147483647.0;
/// That a run can tell; a stranger's recording may have any number.
constexpr int kMostMessages = 100'000;

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

template <typename Row>
void read_rows(std::string_view bytes, std::vector<Row>& rows) {
  rows.resize(bytes.size() / sizeof(Row));
  if (!rows.empty()) {
    std::memcpy(static_cast<void*>(rows.data()), bytes.data(), rows.size() * sizeof(Row));
  }
}

DeviceState state_of(std::string_view name) {
  const DeviceStateRow* row = row_named(kDeviceStates, name);
  if (row == nullptr) throw SqliteFailure{true};
  return row->value;
}

/// Reads the fields of a record from the columns of a row, one after the other.
struct RowReader {
  const SqliteStatement& row;
  double servo_step;  ///< of the record's finger
  int column = 0;

  void read(double& value) { value = row.number(column++); }
  template <std::integral Whole>
  void read(Whole& value) {
    value = static_cast<Whole>(row.integer(column++));
  }
  void read(Vector3& vector) {
    for (double& value : vector) read(value);
  }
  void read(StoredPose& pose) {
    read(pose.translation);
    for (double* value :
         {&pose.rotation.w(), &pose.rotation.x(), &pose.rotation.y(), &pose.rotation.z()}) {
      read(*value);
    }
  }
  void read(Configuration& numbers) {
    const std::string_view bytes = row.bytes(column++);
    const std::size_t count = bytes.size() / sizeof(double);
    if (count > static_cast<std::size_t>(kMaxDegreesOfFreedom)) throw SqliteFailure{true};
    numbers.resize(static_cast<Eigen::Index>(count));
    if (count > 0) std::memcpy(numbers.data(), bytes.data(), count * sizeof(double));
  }
  void read(Targets<FormedCommand> targets) {
    Configuration set_points;
    read(set_points);
    if (set_points.size() > FormedCommand::kMaxServos) throw SqliteFailure{true};
    targets.command.servos = static_cast<int>(set_points.size());
    targets.command.targets.fill(0);
    for (Eigen::Index i = 0; i < set_points.size(); ++i) {
      if (!(std::abs(set_points[i] / servo_step) < kMostSteps)) throw SqliteFailure{true};
      targets.command.targets[static_cast<std::size_t>(i)] =
          static_cast<std::int32_t>(std::lround(set_points[i] / servo_step));
    }
  }
  void read(DeviceState& state) { state = state_of(row.bytes(column++)); }
};

std::uint64_t hash_of(const std::string& hexadecimal) {
  std::uint64_t hash = 0;
  const char* end = hexadecimal.data() + hexadecimal.size();
  const auto [stopped, error] = std::from_chars(hexadecimal.data(), end, hash, 16);
  if (error != std::errc() || stopped != end) throw SqliteFailure{true};
  return hash;
}

/// A row of an object that moves.
template <typename Fields, typename Record>
bool read_next_object(SqliteStatement& rows, Fields fields, const RecordingInfo& info,
                      Record& record) {
  if (!rows.next()) return false;
  const std::int64_t object = rows.integer(recording_layout::kObjectColumn);
  const bool known = std::ranges::any_of(
      info.objects, [&](const RecordingInfo::Object& one) { return one.object == object; });
  if (!known) throw SqliteFailure{true};
  RowReader reader{rows, 1.0};
  for_each_field(fields, [&](const auto& field) { reader.read(field.of(record)); });
  return true;
}

bool read_next(SqliteStatement& rows, const RecordingInfo& info, EventRecord& record) {
  if (!rows.next()) return false;
  RowReader reader{rows, 1.0};
  for_each_field(kEventFields, [&](const auto& field) { reader.read(field.of(record)); });
  const auto things = static_cast<std::int64_t>(info.object_names.size() + info.fingers.size());
  const bool known = record.kind >= 0 && record.kind < std::ssize(kEventKinds) &&
                     record.object >= 0 && record.object < things && record.other >= -1 &&
                     record.other < things;
  if (!known) throw SqliteFailure{true};
  return true;
}

/// The next row of `rows`; false at the end.
template <typename Fields, typename Record>
bool read_next(SqliteStatement& rows, Fields fields, const RecordingInfo& info, Record& record) {
  if (!rows.next()) return false;
  const std::int64_t finger = rows.integer(recording_layout::kFingerColumn);
  if (finger < 0 || finger >= static_cast<std::int64_t>(info.fingers.size())) {
    throw SqliteFailure{true};
  }
  RowReader reader{rows, info.fingers[static_cast<std::size_t>(finger)].servo_step};
  for_each_field(fields, [&](const auto& field) { reader.read(field.of(record)); });
  return true;
}

/// Whether a file is a database with a write-ahead log, by its header.
bool has_log(const std::filesystem::path& file) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  constexpr std::size_t kReadVersion = 19;
  std::array<char, kReadVersion + 1> header{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(header.data(), header.size());
  return stream && std::string_view(header.data(), kMagic.size()) == kMagic &&
         header[kReadVersion] == 2;
}

/// Whether a change of it is to be undone first.
bool is_half_closed(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::file_size(file.string() + "-journal", error) > 0 && !error;
}

}  // namespace

struct RecordingReader::Database {
  Database(const std::filesystem::path& file, SqliteDatabase::Mode mode) : connection(file, mode) {
    SqliteStatement id(connection, "pragma application_id");
    if (!id.next() || id.integer(0) != recording_layout::kApplicationId) throw SqliteFailure{true};
    SqliteStatement check(connection, "pragma quick_check(1)");
    if (!check.next() || check.text(0) != "ok") throw SqliteFailure{true};
  }

  void rewind() {
    steps.emplace(connection, recording_layout::step_query(columns_of("steps")));
    states.emplace(connection, "select nodes, samples from states where step = ? and finger = ?");
    ticks.emplace(connection, recording_layout::tick_query(columns_of("ticks")));
    // Older recordings have no such table.
    const std::set<std::string> of_objects = columns_of("objects");
    if (!of_objects.empty()) {
      objects.emplace(connection, recording_layout::object_query(of_objects));
    }
    if (!columns_of("object_states").empty()) {
      object_states.emplace(connection,
                            "select nodes from object_states where step = ? and object = ?");
    }
    const std::set<std::string> of_events = columns_of("events");
    if (!of_events.empty()) events.emplace(connection, recording_layout::event_query(of_events));
    const std::set<std::string> of_bones = columns_of("bones");
    if (!of_bones.empty()) bones.emplace(connection, recording_layout::bone_query(of_bones));
  }

  [[nodiscard]] std::set<std::string> columns_of(const char* table) {
    SqliteStatement query(connection,
                          fmt::format("select name from pragma_table_info('{}')", table));
    std::set<std::string> columns;
    while (query.next()) columns.insert(query.text(0));
    return columns;
  }

  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key) {
    SqliteStatement query(connection, "select value from meta where key = ?");
    query.bind(0, key);
    if (!query.next()) return std::nullopt;
    return query.integer(0);
  }

  [[nodiscard]] RecordingInfo read_info() {
    RecordingInfo info;
    SqliteStatement meta(connection, "select key, value from meta");
    std::vector<std::string> linear;  // numbers of fingers, see kLinearJointsKey
    std::map<std::string, std::string> poses;
    std::map<std::string, std::string> servo_units;
    std::map<std::string, double> servo_steps;
    while (meta.next()) {
      const std::string key = meta.text(0);
      if (key == "format_version") info.format_version = meta.integer(1);
      if (key == "program_version") info.program_version = meta.text(1);
      if (key == "instruction_set") info.instruction_set = meta.text(1);
      if (key == "scene") info.scene = meta.text(1);
      if (key == "person") info.person = meta.text(1);
      if (key == "simulation_rate_Hz") info.simulation_rate = meta.number(1);
      if (key == "live") info.live = meta.integer(1) != 0;
      if (key == "with_state") info.with_state = meta.integer(1) != 0;
      if (key.starts_with(recording_layout::kLinearJointsKey)) {
        linear.push_back(key.substr(recording_layout::kLinearJointsKey.size()));
      }
      if (key.starts_with(recording_layout::kPosesKey)) {
        poses[key.substr(recording_layout::kPosesKey.size())] = meta.text(1);
      }
      if (key.starts_with(recording_layout::kServoUnitKey)) {
        servo_units[key.substr(recording_layout::kServoUnitKey.size())] = meta.text(1);
      }
      if (key.starts_with(recording_layout::kServoStepKey)) {
        servo_steps[key.substr(recording_layout::kServoStepKey.size())] = meta.number(1);
      }
      if (key.starts_with(recording_layout::kMeshKey)) {
        info.meshes.push_back(
            {key.substr(recording_layout::kMeshKey.size()), hash_of(meta.text(1))});
      }
    }
    if (!(info.simulation_rate > 0.0)) throw SqliteFailure{true};
    SqliteStatement fingers(connection, "select * from fingers order by finger");
    while (fingers.next()) {
      RecordingInfo::Finger finger;
      finger.name = fingers.text(1);
      finger.model = fingers.text(2);
      finger.device = fingers.text(3);
      finger.tracker = fingers.text(4);
      finger.configuration_names = split(fingers.text(5));
      finger.joints = fingers.integer(6);
      finger.linear_joints = std::find(linear.begin(), linear.end(),
                                       std::to_string(info.fingers.size())) != linear.end();
      finger.device_rate = fingers.number(7);
      const std::string number = std::to_string(info.fingers.size());
      if (const auto made = poses.find(number); made != poses.end()) finger.poses = made->second;
      if (const auto unit = servo_units.find(number); unit != servo_units.end()) {
        finger.servo_unit = unit->second;
      }
      if (const auto step = servo_steps.find(number); step != servo_steps.end()) {
        finger.servo_step = step->second;
      }
      if (!(finger.servo_step > 0.0)) throw SqliteFailure{true};
      info.fingers.push_back(std::move(finger));
    }
    if (!columns_of("moving_objects").empty()) {
      SqliteStatement moving(connection, "select * from moving_objects order by object");
      while (moving.next()) {
        info.objects.push_back({moving.integer(0), moving.text(1), moving.text(2)});
      }
    }
    if (!columns_of("object_names").empty()) {
      SqliteStatement named(connection, "select name from object_names order by object");
      while (named.next()) info.object_names.push_back(named.text(0));
    }
    SqliteStatement files(connection, "select path, content from files order by path");
    while (files.next()) info.files.push_back({files.text(0), files.text(1)});
    return info;
  }

  SqliteDatabase connection;
  std::optional<SqliteStatement> steps, states, ticks, objects, object_states, events, bones;
  bool with_state = false;
};

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError(
        fmt::format("{}: no such file; a recording is what run --record writes", file.string()));
  }
  try {
    database_ = open();
    const std::int64_t version = database_->integer("format_version").value_or(0);
    if (version != kRecordingFormatVersion) {
      throw InputError(fmt::format("{}: recording of format {}, this program reads format {}",
                                   file.string(), version, kRecordingFormatVersion));
    }
    info_ = database_->read_info();
    dropped_ = database_->integer("dropped").value_or(0);
    complete_ = database_->integer("complete").value_or(0) != 0;
    database_->with_state = info_.with_state;
    database_->rewind();
  } catch (const SqliteFailure&) {
    fail();
  }
}

std::unique_ptr<RecordingReader::Database> RecordingReader::open() const {
  try {
    return std::make_unique<Database>(file_, SqliteDatabase::Mode::kRead);
  } catch (const SqliteFailure& failure) {
    if (is_half_closed(file_)) return roll_back();
    if (!has_log(file_)) throw;
    const std::filesystem::path log = file_.string() + "-wal";
    std::error_code error;
    if (std::filesystem::file_size(log, error) > 0 && !error) {
      if (failure.damaged) throw;
      throw InputError(fmt::format(
          "{}: {} belongs to it, and to read both takes a folder that can be written; copy both "
          "there, under these names",
          file_.string(), log.filename().string()));
    }
  }
  // Its log has ended or is not here, so that nothing has to be made beside it.
  try {
    return std::make_unique<Database>(file_, SqliteDatabase::Mode::kReadImmutable);
  } catch (const SqliteFailure&) {
    throw InputError(fmt::format(
        "{0}: was being written when it was copied, and its newest part is in {1}-wal, which "
        "belongs to it; copy both, or copy when the run has ended",
        file_.string(), file_.filename().string()));
  }
}

/// A disk failed as the run closed it: the last change is undone as SQLite does it.
std::unique_ptr<RecordingReader::Database> RecordingReader::roll_back() const {
  try {
    SqliteDatabase(file_, SqliteDatabase::Mode::kRollBack).execute("select 1 from sqlite_master");
    return std::make_unique<Database>(file_, SqliteDatabase::Mode::kRead);
  } catch (const SqliteFailure&) {
    throw InputError(
        fmt::format("{0}: could not be closed when its run ended, and {1}-journal says how to undo "
                    "that; copy both, under these names, to a folder that can be written",
                    file_.string(), file_.filename().string()));
  }
}

RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

void RecordingReader::fail() const {
  throw InputError(
      fmt::format("{}: is no recording or is damaged; a recording is what run --record "
                  "writes",
                  file_.string()));
}

void RecordingReader::rewind() {
  try {
    database_->rewind();
  } catch (const SqliteFailure&) {
    fail();
  }
}

void RecordingReader::watch(std::function<void(double)> watch) {
  watch_ = std::move(watch);
  last_step_ = last_step();
}

void RecordingReader::tell(std::int64_t step) {
  constexpr int kRowsBetween = 32;
  if (!watch_ || ++untold_ < kRowsBetween) return;
  untold_ = 0;
  watch_(last_step_ > 0 ? static_cast<double>(step) / static_cast<double>(last_step_) : 1.0);
}

std::int64_t RecordingReader::last_step() {
  try {
    SqliteStatement query(database_->connection, "select max(step) from steps");
    const std::int64_t last = query.next() ? query.integer(0) : 0;
    if (!info_.fingers.empty() || !database_->objects) return last;
    SqliteStatement moved(database_->connection, "select max(step) from objects");
    return moved.next() ? moved.integer(0) : 0;
  } catch (const SqliteFailure&) {
    fail();
  }
}

std::string RecordingReader::how_it_was_cut() {
  if (complete_) return {};
  return fmt::format(
      "{0}: ends at step {1} because its run was cut there or goes on; if it was copied during the "
      "run, the rest is in {2}-wal, which belongs beside it",
      file_.string(), last_step(), file_.filename().string());
}

std::vector<RecordedMessage> RecordingReader::messages() {
  try {
    std::vector<RecordedMessage> messages;
    if (database_->columns_of("messages").empty()) return messages;
    SqliteStatement rows(database_->connection,
                         fmt::format("select step, time_s, since_start_s, message from messages "
                                     "order by number limit {}",
                                     kMostMessages));
    while (rows.next()) {
      messages.push_back({rows.integer(0), rows.number(1), rows.number(2), rows.text(3)});
    }
    return messages;
  } catch (const SqliteFailure&) {
    fail();
  }
}

bool RecordingReader::next(StepRecord& r) {
  try {
    if (!read_next(*database_->steps, kStepFields, info_, r)) return false;
    tell(r.step);
    r.nodes_W.clear();
    r.samples.clear();
    if (database_->with_state) {
      SqliteStatement& state = *database_->states;
      state.bind(0, r.step);
      state.bind(1, r.finger);
      if (state.next()) {
        read_rows(state.bytes(0), r.nodes_W);
        read_rows(state.bytes(1), r.samples);
        while (state.next()) {
        }
      }
    }
    return true;
  } catch (const SqliteFailure&) {
    fail();
  }
}

bool RecordingReader::next(ObjectRecord& r) {
  try {
    if (!database_->objects || !read_next_object(*database_->objects, kObjectFields, info_, r)) {
      return false;
    }
    tell(r.step);
    r.nodes_W.clear();
    if (database_->with_state && database_->object_states) {
      SqliteStatement& state = *database_->object_states;
      state.bind(0, r.step);
      state.bind(1, r.object);
      if (state.next()) {
        read_rows(state.bytes(0), r.nodes_W);
        while (state.next()) {
        }
      }
    }
    return true;
  } catch (const SqliteFailure&) {
    fail();
  }
}

bool RecordingReader::next(EventRecord& r) {
  try {
    return database_->events && read_next(*database_->events, info_, r);
  } catch (const SqliteFailure&) {
    fail();
  }
}

bool RecordingReader::next(FollowRecord& r) {
  try {
    return database_->bones && read_next_object(*database_->bones, kFollowFields, info_, r);
  } catch (const SqliteFailure&) {
    fail();
  }
}

bool RecordingReader::next(TickRecord& r) {
  try {
    return read_next(*database_->ticks, kTickFields, info_, r);
  } catch (const SqliteFailure&) {
    fail();
  }
}

}  // namespace softfinger
