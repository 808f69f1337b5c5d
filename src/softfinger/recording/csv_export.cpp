#include "softfinger/recording/csv_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/csv_writer.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kPoseColumns = "x_mm,y_mm,z_mm,qw,qx,qy,qz";

void write_pose(CsvWriter& csv, const StoredPose& pose) {
  for (int i = 0; i < 3; ++i) csv.field(pose.translation[i] / mm);
  csv.field(pose.rotation.w());
  csv.field(pose.rotation.x());
  csv.field(pose.rotation.y());
  csv.field(pose.rotation.z());
}

void write_vector(CsvWriter& csv, const Vector3& vector, double unit) {
  for (int i = 0; i < 3; ++i) csv.field(vector[i] / unit);
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
    const auto configuration =
        open("configuration.csv",
             names_.empty() ? "deviation_mm2" : fmt::format("{},{}deviation_mm2", names, wanted));
    const auto force = open("force.csv", "measured_force_N,travel_offset_mm,travel_ceiling_mm");
    const auto joints = open("joints.csv", fmt::format("{}{}{}", numbered(angles_, "joint", "deg"),
                                                       angles_ > 0 && lengths_ > 0 ? "," : "",
                                                       numbered(lengths_, "joint", "mm")));
    const std::int64_t servos =
        std::min<std::int64_t>(std::max(angles_, lengths_), FormedCommand::kMaxServos);
    const auto command = open(
        "command.csv",
        fmt::format("{}{}state", numbered(servos, "servo", servo_unit()), servos > 0 ? "," : ""));
    TickRecord tick;
    while (reader_.next(tick)) {
      begin_row(*configuration, tick);
      write_configuration(*configuration, finger_of(tick), tick.command.configuration);
      write_configuration(*configuration, finger_of(tick), tick.wanted);
      configuration->field(tick.deviation / mm2);
      configuration->end_row();

      begin_row(*force, tick);
      force->field(tick.reading.configuration.size() > 0 ? tick.reading.normal_force : kMissing);
      force->field(tick.travel_offset / mm);
      force->field(std::isfinite(tick.command.ceiling) ? tick.command.ceiling / mm : kMissing);
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
      command->field(state_name(tick.command.state));
      command->end_row();

      tick_times_[{tick.step, tick.finger}] = {tick.cpu_time, tick.latency};
    }
    configuration->close();
    force->close();
    joints->close();
    command->close();
  }

  void write_steps() {
    const auto pose = open("pose.csv", kPoseColumns);
    const auto bone = open("bone.csv", kPoseColumns);
    const auto contact =
        open("contact.csv",
             "contact_samples,contact_area_mm2,normal_force_N,tangential_force_N,slip_ratio,"
             "stuck_fraction,centroid_x_mm,centroid_y_mm,centroid_z_mm,normal_x,normal_y,normal_z,"
             "least_gap_mm,normal_force_sum_N");
    const auto timing = open(
        "timing.csv", "step_ms,step_wall_ms,iterations,converged,residual,match_ms,latency_ms");
    StepRecord step;
    while (reader_.next(step)) {
      begin_row(*pose, step);
      if (step.tracked.valid) {
        write_pose(*pose, step.tracked.X_WFt);
      } else {
        pose->missing(7);
      }
      pose->end_row();

      begin_row(*bone, step);
      write_pose(*bone, step.X_WF);
      bone->end_row();

      begin_row(*contact, step);
      contact->field(step.contact_count);
      contact->field(step.contact_area / mm2);
      contact->field(step.normal_force);
      contact->field(step.tangential_force);
      contact->field(step.slip_ratio);
      contact->field(step.stuck_fraction);
      if (step.contact_count > 0) {
        write_vector(*contact, step.centroid_F, mm);
        write_vector(*contact, step.mean_normal_F, 1.0);
      } else {
        contact->missing(6);
      }
      contact->field(step.least_gap / mm);
      contact->field(step.normal_force_sum);
      contact->end_row();

      if (step.step == 0) continue;
      begin_row(*timing, step);
      timing->field(step.cpu_time / ms);
      timing->field(step.wall_time / ms);
      timing->field(step.iterations);
      timing->field(std::int64_t{step.converged});
      timing->field(step.residual);
      const auto tick = tick_times_.find({step.step, step.finger});
      timing->field(tick == tick_times_.end() ? kMissing : tick->second.first / ms);
      timing->field(tick == tick_times_.end() ? kMissing : tick->second.second / ms);
      timing->end_row();
    }
    for (const auto& csv : {&pose, &bone, &contact, &timing}) (*csv)->close();
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
  /// CPU time of the match and latency (s) by step and finger.
  std::map<std::pair<std::int64_t, std::int64_t>, std::pair<double, double>> tick_times_;
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
