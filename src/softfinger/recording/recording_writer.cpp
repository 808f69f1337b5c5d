#include "softfinger/recording/recording_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <concepts>
#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/recording/record_fields.hpp"
#include "softfinger/recording/recording_layout.hpp"
#include "softfinger/recording/sqlite_database.hpp"

namespace softfinger {
namespace {

using Clock = std::chrono::steady_clock;

// A second of steps at 1 kHz and five fingers; less where a step carries its whole state.
constexpr std::size_t kStepCapacity = 8192;
constexpr std::size_t kStateStepCapacity = 512;
constexpr std::size_t kTickCapacity = 256;
constexpr std::size_t kObjectCapacity = 1024;  // for each object; as for steps
constexpr std::size_t kStateObjectCapacity = 128;
constexpr std::size_t kObjectsARound = 1024;
constexpr std::size_t kEventCapacity = 4096;
constexpr std::size_t kStepsARound = 64;  // of a round
constexpr auto kDrainInterval = std::chrono::milliseconds(5);

[[noreturn]] void refuse_to_create(const std::filesystem::path& file, int error) {
  if (error == EEXIST) {
    throw InputError(fmt::format(
        "{}: exists already; a recording never overwrites a file, name a new one", file.string()));
  }
  throw InputError(fmt::format("{}: cannot be created: {}", file.string(),
                               std::system_category().message(error)));
}

/// It has how a person moved, and where there is one their file: nobody else's to read. The log
/// that SQLite puts beside it gets the same permissions.
void create_empty(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor < 0) refuse_to_create(file, errno);
  ::close(descriptor);
}

/// Binds the fields of a record to the parameters of an insertion, one after the other.
struct RowBinder {
  SqliteStatement& row;
  double servo_step;  ///< of the record's finger
  int column = 0;

  void add(double value) { row.bind(column++, value); }
  void add(std::integral auto value) { row.bind(column++, static_cast<std::int64_t>(value)); }
  void add(const Vector3& vector) {
    for (const double value : vector) add(value);
  }
  void add(const StoredPose& pose) {
    add(pose.translation);
    add(pose.rotation.w());
    add(Vector3(pose.rotation.vec()));
  }
  void add(const Configuration& numbers) {
    row.bind_blob(column++, numbers.data(),
                  static_cast<std::size_t>(numbers.size()) * sizeof(double));
  }
  void add(Targets<const FormedCommand> targets) {
    Configuration set_points(targets.command.servos);
    for (int i = 0; i < targets.command.servos; ++i) {
      set_points[i] = targets.command.targets[static_cast<std::size_t>(i)] * servo_step;
    }
    add(set_points);
  }
  void add(DeviceState state) { row.bind(column++, state_name(state)); }
};

template <typename Fields, typename Record>
void insert(SqliteStatement& statement, Fields fields, const Record& record, double servo_step) {
  RowBinder binder{statement, servo_step};
  for_each_field(fields, [&](const auto& field) { binder.add(field.of(record)); });
  statement.run();
}

}  // namespace

void refuse_unless_recordable(const std::filesystem::path& file) {
  std::error_code error;
  // A link to nowhere is there, too.
  if (std::filesystem::exists(std::filesystem::symlink_status(file, error))) {
    refuse_to_create(file, EEXIST);
  }
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (::access((folder / "").c_str(), W_OK | X_OK) != 0) refuse_to_create(file, errno);
}

struct RecordingWriter::Database {
  explicit Database(const std::filesystem::path& file)
      : connection(file, SqliteDatabase::Mode::kCreate) {
    // Commits do not sync; where it begins the log anew one would.
    connection.execute("pragma journal_mode = wal; pragma synchronous = normal;");
    connection.leave_checkpoints_to_others();
    connection.execute(
        fmt::format("pragma application_id = {};", recording_layout::kApplicationId).c_str());
    connection.execute("begin");
    connection.execute(recording_layout::create_tables().c_str());
    insert_meta.emplace(connection, "insert or replace into meta values (?,?)");
    insert_step.emplace(connection, recording_layout::insert_step());
    insert_tick.emplace(connection, recording_layout::insert_tick());
    insert_object.emplace(connection, recording_layout::insert_object());
    insert_event.emplace(connection, recording_layout::insert_event());
    insert_bone.emplace(connection, recording_layout::insert_bone());
    insert_state.emplace(connection, recording_layout::insert_into("states", 4));
    insert_object_state.emplace(connection, recording_layout::insert_into("object_states", 3));
    insert_message.emplace(connection, recording_layout::insert_into("messages", 5));
  }

  /// One file and nothing beside it, so that it can be read where nothing can be written. Where
  /// that does not work, because somebody reads it just now, it stays valid as it is.
  void leave_log() {
    insert_meta.reset();
    insert_step.reset();
    insert_tick.reset();
    insert_object.reset();
    insert_event.reset();
    insert_bone.reset();
    insert_state.reset();
    insert_object_state.reset();
    insert_message.reset();
    try {
      connection.execute("pragma journal_mode = delete");
    } catch (const SqliteFailure&) {
      return;
    }
  }

  void meta(std::string_view key, std::string_view value) {
    insert_meta->bind(0, key);
    insert_meta->bind(1, value);
    insert_meta->run();
  }
  void meta(std::string_view key, std::int64_t value) {
    insert_meta->bind(0, key);
    insert_meta->bind(1, value);
    insert_meta->run();
  }
  void meta(std::string_view key, double value) {
    insert_meta->bind(0, key);
    insert_meta->bind(1, value);
    insert_meta->run();
  }

  void write(const RecordingInfo& info) {
    meta("format_version", info.format_version);
    meta("program_version", info.program_version);
    meta("instruction_set", info.instruction_set);
    meta("scene", info.scene.string());
    if (!info.person.empty()) meta("person", info.person.string());
    meta("simulation_rate_Hz", info.simulation_rate);
    meta("live", std::int64_t{info.live});
    meta("with_state", std::int64_t{info.with_state});
    meta("dropped", std::int64_t{0});
    meta("complete", std::int64_t{0});
    SqliteStatement insert_file(connection, "insert or ignore into files values (?,?)");
    for (const RecordingInfo::File& file : info.files) {
      insert_file.bind(0, file.path.string());
      insert_file.bind_blob(1, file.content.data(), file.content.size());
      insert_file.run();
    }
    for (const RecordingInfo::Mesh& mesh : info.meshes) {
      meta(recording_layout::kMeshKey + mesh.path.string(), fmt::format("{:016x}", mesh.hash));
    }
    SqliteStatement insert_moving(connection, recording_layout::insert_into("moving_objects", 3));
    for (const RecordingInfo::Object& object : info.objects) {
      insert_moving.bind(0, object.object);
      insert_moving.bind(1, object.name);
      insert_moving.bind(2, object.joint_unit);
      insert_moving.run();
    }
    SqliteStatement insert_name(connection, recording_layout::insert_into("object_names", 2));
    for (std::size_t o = 0; o < info.object_names.size(); ++o) {
      insert_name.bind(0, static_cast<std::int64_t>(o));
      insert_name.bind(1, info.object_names[o]);
      insert_name.run();
    }
    SqliteStatement insert_finger(connection, recording_layout::insert_into("fingers", 8));
    for (std::size_t i = 0; i < info.fingers.size(); ++i) {
      const RecordingInfo::Finger& finger = info.fingers[i];
      insert_finger.bind(0, static_cast<std::int64_t>(i));
      insert_finger.bind(1, finger.name);
      insert_finger.bind(2, finger.model.string());
      insert_finger.bind(3, finger.device.string());
      insert_finger.bind(4, finger.tracker);
      insert_finger.bind(5, fmt::format("{}", fmt::join(finger.configuration_names, ",")));
      insert_finger.bind(6, finger.joints);
      insert_finger.bind(7, finger.device_rate);
      insert_finger.run();
      if (finger.linear_joints) {
        meta(recording_layout::kLinearJointsKey + std::to_string(i), "1");
      }
      if (!finger.poses.empty()) {
        meta(recording_layout::kPosesKey + std::to_string(i), finger.poses);
      }
      servo_steps.push_back(finger.servo_step);
      if (finger.servo_unit != RecordingInfo::Finger{}.servo_unit) {
        meta(recording_layout::kServoUnitKey + std::to_string(i), finger.servo_unit);
        meta(recording_layout::kServoStepKey + std::to_string(i), finger.servo_step);
      }
    }
  }

  void write(const StepRecord& r) {
    insert(*insert_step, kStepFields, r, servo_step_of(r.finger));
    if (r.nodes_W.empty()) return;
    insert_state->bind(0, r.step);
    insert_state->bind(1, r.finger);
    insert_state->bind_blob(2, r.nodes_W.data(), r.nodes_W.size() * sizeof(Vector3));
    insert_state->bind_blob(3, r.samples.data(), r.samples.size() * sizeof(SampleRecord));
    insert_state->run();
  }

  void write(const TickRecord& r) { insert(*insert_tick, kTickFields, r, servo_step_of(r.finger)); }

  void write(const ObjectRecord& r) {
    insert(*insert_object, kObjectFields, r, 1.0);
    if (r.nodes_W.empty()) return;
    insert_object_state->bind(0, r.step);
    insert_object_state->bind(1, r.object);
    insert_object_state->bind_blob(2, r.nodes_W.data(), r.nodes_W.size() * sizeof(Vector3));
    insert_object_state->run();
  }
  void write(const EventRecord& r) { insert(*insert_event, kEventFields, r, 1.0); }
  void write(const FollowRecord& r) { insert(*insert_bone, kFollowFields, r, 1.0); }

  void write(const RecordedMessage& message) {
    insert_message->bind(0, ++messages);
    insert_message->bind(1, message.step);
    insert_message->bind(2, message.time);
    insert_message->bind(3, message.since_start);
    insert_message->bind(4, message.text);
    insert_message->run();
  }

  [[nodiscard]] double servo_step_of(std::int64_t finger) const {
    return servo_steps[static_cast<std::size_t>(finger)];
  }

  void begin(Checkpointer::Begin how) {
    syncs_header = how != Checkpointer::Begin::kInEmptyLog;
    if (!syncs_header) connection.execute("pragma synchronous = off");
    connection.execute("begin");
    in_transaction = true;
    began = Clock::now();
  }
  void commit() {
    connection.execute("commit");
    in_transaction = false;
    if (!syncs_header) connection.execute("pragma synchronous = normal");
  }

  SqliteDatabase connection;
  std::vector<double> servo_steps;  ///< of the fingers
  std::optional<SqliteStatement> insert_meta, insert_step, insert_tick, insert_object, insert_event,
      insert_bone, insert_state, insert_object_state, insert_message;
  std::int64_t messages = 0;  ///< written
  bool in_transaction = true;
  bool syncs_header = true;  ///< of the log, where it begins anew
  Clock::time_point began = Clock::now();
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingInfo& info,
                                 WhenFull when_full, const StepRecord& step_prototype,
                                 LogLimits log, const ObjectRecord& object_prototype)
    : file_(file),
      when_full_(when_full),
      steps_(info.with_state ? kStateStepCapacity : kStepCapacity, step_prototype),
      objects_(std::max<std::size_t>(1, info.objects.size()) *
                   (info.with_state ? kStateObjectCapacity : kObjectCapacity),
               object_prototype),
      events_(info.objects.empty() ? 1 : kEventCapacity),
      bones_(std::max<std::size_t>(1, info.objects.size()) * kObjectCapacity) {
  create_empty(file);
  for (std::size_t i = 0; i < info.fingers.size(); ++i) {
    ticks_.push_back(std::make_unique<RingBuffer<TickRecord>>(kTickCapacity));
  }
  try {
    database_ = std::make_unique<Database>(file);
    database_->write(info);
    database_->commit();
  } catch (const SqliteFailure&) {
    throw OperationError(
        fmt::format("{}: the recording cannot be written (is there room on the "
                    "disk?)",
                    file.string()));
  }
  checkpointer_ = std::make_unique<Checkpointer>(file, log);
  thread_ = std::thread([this] { write_until_closed(); });
}

RecordingWriter::~RecordingWriter() {
  closing_ = true;
  if (thread_.joinable()) thread_.join();
}

template <typename Record>
void RecordingWriter::push_to(RingBuffer<Record>& ring, const Record& record) {
  Record* slot = ring.claim();
  while (slot == nullptr && when_full_ == WhenFull::kWait) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    slot = ring.claim();
  }
  if (slot == nullptr) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  *slot = record;
  ring.publish();
}

void RecordingWriter::push(const StepRecord& record) { push_to(steps_, record); }

void RecordingWriter::push(const ObjectRecord& record) { push_to(objects_, record); }

void RecordingWriter::push(const EventRecord& record) { push_to(events_, record); }

void RecordingWriter::push(const FollowRecord& record) { push_to(bones_, record); }

void RecordingWriter::push(const TickRecord& record) {
  push_to(*ticks_[static_cast<std::size_t>(record.finger)], record);
}

void RecordingWriter::push(std::int64_t step, double time, const std::string& message) {
  const std::chrono::duration<double> since = Clock::now() - start_;
  const std::lock_guard lock(messages_mutex_);
  if (messages_.size() < kMostMessages) messages_.push_back({step, time, since.count(), message});
}

void RecordingWriter::write_messages() {
  std::vector<RecordedMessage> messages;
  {
    const std::lock_guard lock(messages_mutex_);
    messages.swap(messages_);
  }
  if (failed_ || messages.empty()) return;
  try {
    for (const RecordedMessage& message : messages) database_->write(message);
  } catch (const SqliteFailure&) {
    failed_ = true;
  }
}

// One round: what is there now, but not so much that the next commit is late. Steps before ticks,
// and no commit between: a step never names a tick that was not handed over before it, so none is
// committed without it.
bool RecordingWriter::drain() {
  const auto take = [&](auto& ring, std::size_t most) {
    for (std::size_t i = 0; i < most; ++i) {
      const auto* record = ring.front();
      if (record == nullptr) return false;
      if (!failed_) {
        try {
          database_->write(*record);
        } catch (const SqliteFailure&) {
          failed_ = true;
        }
      }
      ring.release();
    }
    return true;
  };
  write_messages();
  bool more = take(steps_, kStepsARound);
  more = take(objects_, kObjectsARound) || more;
  more = take(events_, kEventCapacity) || more;
  more = take(bones_, kObjectsARound) || more;
  for (auto& ring : ticks_) more = take(*ring, ring->capacity()) || more;
  return more;
}

bool RecordingWriter::rows_wait() {
  if (steps_.front() != nullptr || objects_.front() != nullptr) return true;
  if (events_.front() != nullptr || bones_.front() != nullptr) return true;
  if (std::ranges::any_of(ticks_, [](auto& ring) { return ring->front() != nullptr; })) return true;
  const std::lock_guard lock(messages_mutex_);
  return !messages_.empty();
}

bool RecordingWriter::may_write() {
  if (failed_ || database_->in_transaction) return true;
  if (!rows_wait()) return false;
  const Checkpointer::Begin how = checkpointer_->begin();
  if (how == Checkpointer::Begin::kLater) return false;
  begin(how);
  return true;
}

void RecordingWriter::begin(Checkpointer::Begin how) {
  try {
    database_->begin(how);
  } catch (const SqliteFailure&) {
    failed_ = true;
  }
}

void RecordingWriter::commit() {
  try {
    database_->commit();
    checkpointer_->committed(database_->connection.log_pages());
  } catch (const SqliteFailure&) {
    failed_ = true;
  }
}

void RecordingWriter::write_until_closed() {
  while (!closing_) {
    const bool more = may_write() && drain();
    if (!failed_ && database_->in_transaction &&
        Clock::now() - database_->began > std::chrono::duration<double>(kCommitInterval)) {
      commit();
    }
    if (!more) std::this_thread::sleep_for(kDrainInterval);
  }
}

void RecordingWriter::close() {
  if (!thread_.joinable()) return;
  closing_ = true;
  thread_.join();
  if (!failed_ && !database_->in_transaction) begin(checkpointer_->begin_at_once());
  while (drain()) {
  }
  try {
    if (!failed_) {
      database_->meta("dropped", static_cast<std::int64_t>(dropped()));
      database_->meta("complete", std::int64_t{1});
      database_->commit();
    }
  } catch (const SqliteFailure&) {
    failed_ = true;
  }
  checkpointer_->stop();
  if (!failed_) database_->leave_log();
  database_.reset();
  if (failed_) {
    throw OperationError(
        fmt::format("{}: the recording could not be written to its end (is there "
                    "room on the disk?)",
                    file_.string()));
  }
}

}  // namespace softfinger
