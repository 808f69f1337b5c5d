#include "softfinger/recording/recording_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/recording/record_fields.hpp"

namespace softfinger {
namespace {

using Columns = std::vector<TableColumn>;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Words of a vocabulary.
TableColumn words_of(std::string_view name, const std::vector<std::string>& vocabulary) {
  TableColumn column{.name = std::string(name), .words = true, .most_bytes = 1};
  for (const std::string& word : vocabulary) {
    column.most_bytes = std::max(column.most_bytes, word.size());
  }
  return column;
}

/// Of the names in "x_mm,y_mm,z_mm".
void add_numbers(Columns& columns, std::string_view names) {
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(','), names.size());
    columns.push_back({.name = std::string(names.substr(0, end))});
    names.remove_prefix(std::min(end + 1, names.size()));
  }
}

/// "PREFIX_1_UNIT", "PREFIX_2_UNIT", ...
void add_numbered(Columns& columns, std::int64_t count, const char* prefix,
                  const std::string& unit) {
  for (std::int64_t i = 1; i <= count; ++i) {
    columns.push_back({.name = fmt::format("{}_{}{}{}", prefix, i, unit.empty() ? "" : "_", unit)});
  }
}

void add(Columns& columns, const Columns& more) {
  columns.insert(columns.end(), more.begin(), more.end());
}

void write_vector(TableWriter& table, const Vector3& vector, double unit) {
  for (int i = 0; i < 3; ++i) table.number(vector[i] / unit);
}

void write(TableWriter& table, double value, double unit) { table.number(value / unit); }
void write(TableWriter& table, std::integral auto value, double) {
  table.number(static_cast<double>(value));
}
void write(TableWriter& table, const Vector3& vector, double unit) {
  write_vector(table, vector, unit);
}
void write(TableWriter& table, const StoredPose& pose, double unit) {
  write_vector(table, pose.translation, unit);
  table.number(pose.rotation.w());
  write_vector(table, pose.rotation.vec(), 1.0);
}
void write(TableWriter& table, DeviceState state, double) { table.words(state_name(state)); }
// Their columns are what the fingers of the recording say; see Export::write_ticks.
void write(TableWriter&, const Configuration&, double) {}
void write(TableWriter&, Targets<const FormedCommand>, double) {}

/// The fields that have columns of their own in a file, in its order; those of a step come first.
template <typename Visit>
void for_each_field_of(CsvFile file, Visit&& visit) {
  for (int rank = 0; rank <= kLastCsvRank; ++rank) {
    const auto take = [&](const auto& field) {
      const auto& csv = field.use.csv;
      if (csv.file == file && csv.rank == rank && !csv.columns.empty()) visit(field);
    };
    for_each_field(kStepFields, take);
    for_each_field(kTickFields, take);
    for_each_field(kObjectFields, take);
    for_each_field(kEventFields, take);
  }
}

Columns columns_of(CsvFile file) {
  Columns columns;
  for_each_field_of(
      file, [&]<typename Record, auto... Path>(const Field<Record, Path...>& field) {
        const Record record;
        if constexpr (std::is_same_v<std::decay_t<decltype(field.of(record))>, DeviceState>) {
          columns.push_back(words_of(field.use.csv.columns, names_of(kDeviceStates)));
        } else {
          add_numbers(columns, field.use.csv.columns);
        }
      });
  return columns;
}

template <typename Record, auto... Path>
void write_field(TableWriter& table, const Field<Record, Path...>& field, const Record& record) {
  const CsvPlace<Record>& place = field.use.csv;
  if (place.known != nullptr && !place.known(record)) {
    table.missing(column_count(place.columns));
  } else {
    write(table, field.of(record), unit_scale(place.columns.substr(0, place.columns.find(','))));
  }
}

/// What a row of a file has of a step and of a tick; null: there is none.
void write_fields(TableWriter& table, CsvFile file, const StepRecord* step,
                  const TickRecord* tick) {
  const auto write_one = [&](const auto& field, const auto* record) {
    if (record != nullptr) {
      write_field(table, field, *record);
    } else {
      table.missing(column_count(field.use.csv.columns));
    }
  };
  for_each_field_of(
      file, [&]<typename Record, auto... Path>(const Field<Record, Path...>& field) {
        if constexpr (std::is_same_v<Record, StepRecord>) {
          write_one(field, step);
        } else if constexpr (std::is_same_v<Record, TickRecord>) {
          write_one(field, tick);
        }
      });
}

/// The tables of one export and how a row of each begins.
class Export {
 public:
  Export(RecordingReader& reader, TableStore& store)
      : reader_(reader), store_(store), several_(reader.info().fingers.size() > 1) {
    // Fingers may carry different devices; a column for each name, in order of first appearance.
    for (const RecordingInfo::Finger& finger : reader.info().fingers) {
      finger_names_.push_back(finger.name);
      for (const std::string& name : finger.configuration_names) {
        if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
      }
      std::int64_t& joints = finger.linear_joints ? lengths_ : angles_;
      joints = std::max(joints, finger.joints);
    }
  }

  void write() {
    write_ticks();
    write_steps();
    write_messages();
    if (!reader_.info().objects.empty()) {
      write_objects();
      write_events();
    }
    if (!reader_.info().with_state) return;
    write_states();
    if (!reader_.info().objects.empty()) write_object_states();
  }

 private:
  /// A table whose rows begin as begin_row() says.
  std::unique_ptr<TableWriter> open(const char* name, const Columns& columns) {
    Columns all{{.name = "time_s"}};
    if (several_) all.push_back(words_of("finger", finger_names_));
    add(all, columns);
    return store_.open(name, all);
  }

  template <typename Record>
  void begin_row(TableWriter& table, const Record& record) {
    table.number(record.time);
    if (several_) table.words(finger_of(record).name);
  }

  template <typename Record>
  const RecordingInfo::Finger& finger_of(const Record& record) {
    return reader_.info().fingers[static_cast<std::size_t>(record.finger)];
  }

  void write_configuration(TableWriter& table, const RecordingInfo::Finger& finger,
                           const Configuration& q) {
    for (const std::string& name : names_) {
      const auto at =
          std::find(finger.configuration_names.begin(), finger.configuration_names.end(), name);
      const auto i = at - finger.configuration_names.begin();
      table.number(at != finger.configuration_names.end() && i < q.size() ? q[i] / unit_scale(name)
                                                                          : kMissing);
    }
  }

  void write_joints(TableWriter& table, bool linear, const JointAngles& joints) {
    for (std::int64_t i = 0; i < angles_; ++i) {
      table.number(!linear && i < joints.size() ? joints[i] / deg : kMissing);
    }
    for (std::int64_t i = 0; i < lengths_; ++i) {
      table.number(linear && i < joints.size() ? joints[i] / mm : kMissing);
    }
  }

  /// Of the set points of all fingers with servos; empty where they differ.
  [[nodiscard]] std::string servo_unit() const {
    std::optional<std::string> unit;
    for (const RecordingInfo::Finger& finger : reader_.info().fingers) {
      if (finger.device.empty()) continue;
      if (unit && *unit != finger.servo_unit) return {};
      unit = finger.servo_unit;
    }
    return unit.value_or(RecordingInfo::Finger{}.servo_unit);
  }

  [[nodiscard]] std::int64_t servos() const {
    return std::min<std::int64_t>(std::max(angles_, lengths_), FormedCommand::kMaxServos);
  }

  [[nodiscard]] Columns configuration_columns() const {
    Columns columns;
    for (const std::string& name : names_) columns.push_back({.name = name});
    for (const std::string& name : names_) columns.push_back({.name = "wanted_" + name});
    add(columns, columns_of(CsvFile::kConfiguration));
    return columns;
  }

  [[nodiscard]] Columns joint_columns() const {
    Columns columns;
    add_numbered(columns, angles_, "joint", "deg");
    add_numbered(columns, lengths_, "joint", "mm");
    return columns;
  }

  [[nodiscard]] Columns command_columns() const {
    Columns columns;
    add_numbered(columns, servos(), "servo", servo_unit());
    add(columns, columns_of(CsvFile::kCommand));
    return columns;
  }

  void write_ticks() {
    const auto configuration = open("configuration", configuration_columns());
    const auto force = open("force", columns_of(CsvFile::kForce));
    const auto joints = open("joints", joint_columns());
    const auto command = open("command", command_columns());
    TickRecord tick;
    while (reader_.next(tick)) {
      begin_row(*configuration, tick);
      write_configuration(*configuration, finger_of(tick), tick.command.configuration);
      write_configuration(*configuration, finger_of(tick), tick.wanted);
      write_fields(*configuration, CsvFile::kConfiguration, nullptr, &tick);
      configuration->end_row();

      begin_row(*force, tick);
      write_fields(*force, CsvFile::kForce, nullptr, &tick);
      force->end_row();

      begin_row(*joints, tick);
      write_joints(*joints, finger_of(tick).linear_joints, tick.command.joints);
      joints->end_row();

      begin_row(*command, tick);
      for (std::int64_t i = 0; i < servos(); ++i) {
        command->number(i < tick.command.servos
                            ? tick.command.targets[static_cast<std::size_t>(i)] *
                                  finger_of(tick).servo_step
                            : kMissing);
      }
      write_fields(*command, CsvFile::kCommand, nullptr, &tick);
      command->end_row();
    }
    for (const auto& table : {&configuration, &force, &joints, &command}) (*table)->close();
  }

  void write_steps() {
    reader_.rewind();
    const auto pose = open("pose", columns_of(CsvFile::kPose));
    const auto bone = open("bone", columns_of(CsvFile::kBone));
    const auto contact = open("contact", columns_of(CsvFile::kContact));
    const auto timing = open("timing", columns_of(CsvFile::kTiming));
    StepRecord step;
    TickRecord next_tick;
    bool more_ticks = reader_.next(next_tick);
    while (reader_.next(step)) {
      const auto write_row = [&](TableWriter& table, CsvFile file, const TickRecord* tick) {
        begin_row(table, step);
        write_fields(table, file, &step, tick);
        table.end_row();
      };
      write_row(*pose, CsvFile::kPose, nullptr);
      write_row(*bone, CsvFile::kBone, nullptr);
      write_row(*contact, CsvFile::kContact, nullptr);

      // The last tick of this step and finger; both come in the same order.
      std::optional<TickRecord> tick;
      const auto now = std::pair(step.step, step.finger);
      for (; more_ticks && std::pair(next_tick.step, next_tick.finger) <= now;
           more_ticks = reader_.next(next_tick)) {
        if (std::pair(next_tick.step, next_tick.finger) == now) tick = next_tick;
      }
      if (step.step > 0) write_row(*timing, CsvFile::kTiming, tick ? &*tick : nullptr);
    }
    for (const auto& table : {&pose, &bone, &contact, &timing}) (*table)->close();
  }

  void write_messages() {
    const auto table = store_.open(
        "messages",
        {{.name = "time_s"}, {.name = "since_start_s"}, {.name = "message", .words = true}});
    for (const RecordedMessage& message : reader_.messages()) {
      table->number(message.time);
      table->number(message.since_start);
      table->words(message.text);
      table->end_row();
    }
    table->close();
  }

  void write_objects() {
    reader_.rewind();
    Columns columns{{.name = "time_s"}, words_of("object", moving_names())};
    add(columns, columns_of(CsvFile::kObjects));
    columns.push_back({.name = "joint", .unit = "mm or deg"});
    const auto table = store_.open("objects", columns);
    ObjectRecord record;
    while (reader_.next(record)) {
      const RecordingInfo::Object& object = object_of(record);
      table->number(record.time);
      table->words(object.name);
      for_each_field(kObjectFields, [&](const auto& field) {
        if (field.use.csv.file == CsvFile::kObjects) write_field(*table, field, record);
      });
      table->number(record.joint / unit_scale("_" + object.joint_unit));
      table->end_row();
    }
    table->close();
  }

  void write_events() {
    reader_.rewind();
    const RecordingInfo& info = reader_.info();
    std::vector<std::string> names = info.object_names;
    for (const RecordingInfo::Finger& finger : info.fingers) names.push_back(finger.name);
    Columns columns{{.name = "time_s"},
                    words_of("kind", {kEventKinds.begin(), kEventKinds.end()}),
                    words_of("object", names),
                    words_of("other", names)};
    add(columns, columns_of(CsvFile::kEvents));
    const auto table = store_.open("events", columns);
    EventRecord record;
    while (reader_.next(record)) {
      table->number(record.time);
      table->words(kEventKinds[static_cast<std::size_t>(record.kind)]);
      table->words(names[static_cast<std::size_t>(record.object)]);
      table->words(record.other < 0 ? "" : names[static_cast<std::size_t>(record.other)]);
      table->number(record.impulse);
      table->end_row();
    }
    table->close();
  }

  void write_states() {
    reader_.rewind();
    Columns of_node;
    Columns of_sample;
    add_numbers(of_node, "node,x_mm,y_mm,z_mm");
    add_numbers(of_sample, "sample,x_mm,y_mm,z_mm,gap_mm,force_x_N,force_y_N,force_z_N,in_contact");
    const auto nodes = open("nodes", of_node);
    const auto samples = open("samples", of_sample);
    StepRecord step;
    while (reader_.next(step)) {
      for (std::size_t i = 0; i < step.nodes_W.size(); ++i) {
        begin_row(*nodes, step);
        nodes->number(static_cast<double>(i));
        write_vector(*nodes, step.nodes_W[i], mm);
        nodes->end_row();
      }
      for (std::size_t i = 0; i < step.samples.size(); ++i) {
        const SampleRecord& sample = step.samples[i];
        begin_row(*samples, step);
        samples->number(static_cast<double>(i));
        write_vector(*samples, sample.position_F, mm);
        samples->number(sample.gap / mm);
        write_vector(*samples, sample.force_F, 1.0);
        samples->number(static_cast<double>(static_cast<std::int64_t>(sample.in_contact)));
        samples->end_row();
      }
    }
    nodes->close();
    samples->close();
  }

  void write_object_states() {
    reader_.rewind();
    Columns columns{{.name = "time_s"}, words_of("object", moving_names())};
    add_numbers(columns, "node,x_mm,y_mm,z_mm");
    std::unique_ptr<TableWriter> table;  // where anything is soft
    ObjectRecord record;
    while (reader_.next(record)) {
      for (std::size_t i = 0; i < record.nodes_W.size(); ++i) {
        if (!table) table = store_.open("object_nodes", columns);
        table->number(record.time);
        table->words(object_of(record).name);
        table->number(static_cast<double>(i));
        write_vector(*table, record.nodes_W[i], mm);
        table->end_row();
      }
    }
    if (table) table->close();
  }

  /// Of the objects that move by forces.
  [[nodiscard]] std::vector<std::string> moving_names() const {
    std::vector<std::string> names;
    for (const RecordingInfo::Object& object : reader_.info().objects) {
      names.push_back(object.name);
    }
    return names;
  }

  [[nodiscard]] const RecordingInfo::Object& object_of(const ObjectRecord& record) const {
    return *std::ranges::find(reader_.info().objects, record.object,
                              &RecordingInfo::Object::object);
  }

  RecordingReader& reader_;
  TableStore& store_;
  bool several_;
  std::vector<std::string> finger_names_;
  std::vector<std::string> names_;         ///< of the configurations
  std::int64_t angles_ = 0, lengths_ = 0;  ///< most joints of a device
};

}  // namespace

void write_tables(RecordingReader& reader, TableStore& store) { Export(reader, store).write(); }

}  // namespace softfinger
