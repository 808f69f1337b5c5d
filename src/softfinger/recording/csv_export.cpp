#include "softfinger/recording/csv_export.hpp"

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

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/csv_writer.hpp"
#include "softfinger/recording/record_fields.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
void write_vector(CsvWriter& csv, const Vector3& vector, double unit) {
  for (int i = 0; i < 3; ++i) csv.field(vector[i] / unit);
}

void write(CsvWriter& csv, double value, double unit) { csv.field(value / unit); }
void write(CsvWriter& csv, std::integral auto value, double) {
  csv.field(static_cast<std::int64_t>(value));
}
void write(CsvWriter& csv, const Vector3& vector, double unit) { write_vector(csv, vector, unit); }
void write(CsvWriter& csv, const StoredPose& pose, double unit) {
  write_vector(csv, pose.translation, unit);
  csv.field(pose.rotation.w());
  write_vector(csv, pose.rotation.vec(), 1.0);
}
void write(CsvWriter& csv, DeviceState state, double) { csv.field(state_name(state)); }
// Their columns are what the fingers of the recording say; see Export::write_ticks.
void write(CsvWriter&, const Configuration&, double) {}
void write(CsvWriter&, Targets<const FormedCommand>, double) {}

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
  }
}

std::string columns_of(CsvFile file) {
  std::string columns;
  for_each_field_of(file, [&](const auto& field) {
    columns += fmt::format("{}{}", columns.empty() ? "" : ",", field.use.csv.columns);
  });
  return columns;
}

template <typename Record, auto... Path>
void write_field(CsvWriter& csv, const Field<Record, Path...>& field, const Record& record) {
  const CsvPlace<Record>& place = field.use.csv;
  if (place.known != nullptr && !place.known(record)) {
    csv.missing(column_count(place.columns));
  } else {
    write(csv, field.of(record), unit_scale(place.columns.substr(0, place.columns.find(','))));
  }
}

/// What a row of a file has of a step and of a tick; null: there is none.
void write_fields(CsvWriter& csv, CsvFile file, const StepRecord* step, const TickRecord* tick) {
  const auto write_one = [&](const auto& field, const auto* record) {
    if (record != nullptr) {
      write_field(csv, field, *record);
    } else {
      csv.missing(column_count(field.use.csv.columns));
    }
  };
  for_each_field_of(
      file, [&]<typename Record, auto... Path>(const Field<Record, Path...>& field) {
        if constexpr (std::is_same_v<Record, StepRecord>) {
          write_one(field, step);
        } else {
          write_one(field, tick);
        }
      });
}

/// The files of one export and how a row of each begins.
class Export {
 public:
  Export(RecordingReader& reader, const fs::path& directory)
      : reader_(reader), directory_(directory), several_(reader.info().fingers.size() > 1) {
    // Fingers may carry different devices; a column for each name, in order of first appearance.
    for (const RecordingInfo::Finger& finger : reader.info().fingers) {
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
    if (reader_.info().with_state) write_states();
  }

 private:
  std::unique_ptr<CsvWriter> open(const char* name, const std::string& columns) {
    return std::make_unique<CsvWriter>(directory_ / name,
                                       fmt::format("time_s{}{}{}", several_ ? ",finger" : "",
                                                   columns.empty() ? "" : ",", columns));
  }

  template <typename Record>
  void begin_row(CsvWriter& csv, const Record& record) {
    csv.field(record.time);
    if (several_) csv.field(std::string_view(finger_of(record).name));
  }

  template <typename Record>
  const RecordingInfo::Finger& finger_of(const Record& record) {
    return reader_.info().fingers[static_cast<std::size_t>(record.finger)];
  }

  void write_configuration(CsvWriter& csv, const RecordingInfo::Finger& finger,
                           const Configuration& q) {
    for (const std::string& name : names_) {
      const auto at =
          std::find(finger.configuration_names.begin(), finger.configuration_names.end(), name);
      const auto i = at - finger.configuration_names.begin();
      csv.field(at != finger.configuration_names.end() && i < q.size() ? q[i] / unit_scale(name)
                                                                       : kMissing);
    }
  }

  void write_joints(CsvWriter& csv, bool linear, const JointAngles& joints) {
    for (std::int64_t i = 0; i < angles_; ++i) {
      csv.field(!linear && i < joints.size() ? joints[i] / deg : kMissing);
    }
    for (std::int64_t i = 0; i < lengths_; ++i) {
      csv.field(linear && i < joints.size() ? joints[i] / mm : kMissing);
    }
  }

  /// "PREFIX_1_UNIT,PREFIX_2_UNIT,..."
  [[nodiscard]] static std::string numbered(std::int64_t count, const char* prefix,
                                            const std::string& unit) {
    std::string columns;
    for (std::int64_t i = 1; i <= count; ++i) {
      columns +=
          fmt::format("{}{}_{}{}{}", i > 1 ? "," : "", prefix, i, unit.empty() ? "" : "_", unit);
    }
    return columns;
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

  void write_ticks() {
    const std::string names = fmt::format("{}", fmt::join(names_, ","));
    std::string wanted;
    for (const std::string& name : names_) wanted += fmt::format("wanted_{},", name);
    const std::string others = columns_of(CsvFile::kConfiguration);
    const auto configuration =
        open("configuration.csv",
             names_.empty() ? others : fmt::format("{},{}{}", names, wanted, others));
    const auto force = open("force.csv", columns_of(CsvFile::kForce));
    const auto joints = open("joints.csv", fmt::format("{}{}{}", numbered(angles_, "joint", "deg"),
                                                       angles_ > 0 && lengths_ > 0 ? "," : "",
                                                       numbered(lengths_, "joint", "mm")));
    const std::int64_t servos =
        std::min<std::int64_t>(std::max(angles_, lengths_), FormedCommand::kMaxServos);
    const auto command =
        open("command.csv", fmt::format("{}{}{}", numbered(servos, "servo", servo_unit()),
                                        servos > 0 ? "," : "", columns_of(CsvFile::kCommand)));
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
      for (std::int64_t i = 0; i < servos; ++i) {
        command->field(i < tick.command.servos ? tick.command.targets[static_cast<std::size_t>(i)] *
                                                     finger_of(tick).servo_step
                                               : kMissing);
      }
      write_fields(*command, CsvFile::kCommand, nullptr, &tick);
      command->end_row();
    }
    configuration->close();
    force->close();
    joints->close();
    command->close();
  }

  void write_steps() {
    reader_.rewind();
    const auto pose = open("pose.csv", columns_of(CsvFile::kPose));
    const auto bone = open("bone.csv", columns_of(CsvFile::kBone));
    const auto contact = open("contact.csv", columns_of(CsvFile::kContact));
    const auto timing = open("timing.csv", columns_of(CsvFile::kTiming));
    StepRecord step;
    TickRecord next_tick;
    bool more_ticks = reader_.next(next_tick);
    while (reader_.next(step)) {
      const auto write_row = [&](CsvWriter& csv, CsvFile file, const TickRecord* tick) {
        begin_row(csv, step);
        write_fields(csv, file, &step, tick);
        csv.end_row();
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
    for (const auto& csv : {&pose, &bone, &contact, &timing}) (*csv)->close();
  }

  void write_messages() {
    CsvWriter csv(directory_ / "messages.csv", "time_s,since_start_s,message");
    for (const RecordedMessage& message : reader_.messages()) {
      csv.field(message.time);
      csv.field(message.since_start);
      csv.field(std::string_view(message.text));
      csv.end_row();
    }
    csv.close();
  }

  void write_states() {
    reader_.rewind();
    const auto nodes = open("nodes.csv", "node,x_mm,y_mm,z_mm");
    const auto samples = open(
        "samples.csv", "sample,x_mm,y_mm,z_mm,gap_mm,force_x_N,force_y_N,force_z_N,in_contact");
    StepRecord step;
    while (reader_.next(step)) {
      for (std::size_t i = 0; i < step.nodes_W.size(); ++i) {
        begin_row(*nodes, step);
        nodes->field(static_cast<std::int64_t>(i));
        write_vector(*nodes, step.nodes_W[i], mm);
        nodes->end_row();
      }
      for (std::size_t i = 0; i < step.samples.size(); ++i) {
        const SampleRecord& sample = step.samples[i];
        begin_row(*samples, step);
        samples->field(static_cast<std::int64_t>(i));
        write_vector(*samples, sample.position_F, mm);
        samples->field(sample.gap / mm);
        write_vector(*samples, sample.force_F, 1.0);
        samples->field(static_cast<std::int64_t>(sample.in_contact));
        samples->end_row();
      }
    }
    nodes->close();
    samples->close();
  }

  RecordingReader& reader_;
  fs::path directory_;
  bool several_;
  std::vector<std::string> names_;
  std::int64_t angles_ = 0, lengths_ = 0;  ///< most joints of a device
};

}  // namespace

std::string export_csv(const fs::path& recording, const fs::path& directory) {
  RecordingReader reader(recording);
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) {
    throw InputError(
        fmt::format("{}: cannot be made a directory: {}", directory.string(), error.message()));
  }
  Export(reader, directory).write();
  return reader.how_it_was_cut();
}

}  // namespace softfinger
