#include "softfinger/export/mcap/mcap_export.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "softfinger/export/mcap/mcap_writer.hpp"
#include "softfinger/export/mcap/recorded_fingers.hpp"
#include "softfinger/export/mcap/ros_messages.hpp"
#include "softfinger/export/mcap/skin_pressure.hpp"
#include "softfinger/export/recording_facts.hpp"

namespace softfinger {
namespace {

std::uint64_t nanoseconds(double time) {
  return time > 0.0 ? static_cast<std::uint64_t>(std::llround(time * 1e9)) : 0;
}

std::map<std::string, std::string> as_texts(const std::vector<RecordingFact>& facts) {
  std::map<std::string, std::string> texts;
  for (const RecordingFact& fact : facts) {
    texts[fact.key] =
        std::visit([](const auto& value) { return fmt::format("{}", value); }, fact.value);
  }
  return texts;
}

/// The messages of one recording, in order of time.
class RosExport {
 public:
  RosExport(RecordingReader& reader, FileBeside& file)
      : reader_(reader),
        recorded_(recorded_fingers(reader)),
        messages_(reader.messages()),
        mcap_(file, "softfinger " SOFTFINGER_VERSION) {
    const auto add = [&](const char* topic, const RosType& type) {
      return mcap_.add_channel(topic, type.name, type.schema);
    };
    tf_ = add("/tf", tf_message_type());
    wrench_ = add("/wrench", wrench_stamped_type());
    events_ = add("/events", log_type());
    for (const RecordingInfo::Finger& finger : reader.info().fingers) {
      joint_names_.emplace_back();
      for (std::int64_t i = 1; i <= finger.joints; ++i) {
        joint_names_.back().push_back(fmt::format("{}_joint_{}", finger.name, i));
      }
      if (finger.joints > 0 && !joints_) joints_ = add("/joints", joint_state_type());
    }
    for (const RecordingInfo::Object& object : reader.info().objects) {
      if (!object.joint_unit.empty() && !joints_) joints_ = add("/joints", joint_state_type());
    }
    if (reader.info().with_state) skin_ = add("/skin", point_cloud_type());
    add_soft_objects();
    mcap_.add_metadata("softfinger", as_texts(recording_facts(reader)));
  }

  Exported write() {
    StepRecord step;
    TickRecord tick;
    bool more_ticks = reader_.next(tick);
    more_objects_ = reader_.next(object_);
    more_events_ = reader_.next(event_);
    while (mcap_.ok() && reader_.next(step)) {
      tell_until(step.time);
      write_objects_until(step.step);
      write(step);
      for (; more_ticks && std::pair(tick.step, tick.finger) <= std::pair(step.step, step.finger);
           more_ticks = reader_.next(tick)) {
        write(tick);
      }
    }
    for (; mcap_.ok() && more_ticks; more_ticks = reader_.next(tick)) write(tick);
    write_objects_until(std::numeric_limits<std::int64_t>::max());
    tell_until(std::numeric_limits<double>::infinity());
    mcap_.close();
    return {.whole = mcap_.ok(), .lack = lack()};
  }

 private:
  [[nodiscard]] std::string lack() const {
    if (recorded_.lack.empty()) return {};
    return fmt::format("{}: exported without platforms in /tf and pressures in /skin: {}",
                       reader_.file().string(), recorded_.lack);
  }

  template <typename Record>
  [[nodiscard]] const std::string& name_of(const Record& record) const {
    return reader_.info().fingers[static_cast<std::size_t>(record.finger)].name;
  }
  template <typename Record>
  [[nodiscard]] const RecordedFinger& finger_of(const Record& record) const {
    return recorded_.fingers[static_cast<std::size_t>(record.finger)];
  }
  /// In the frame of the record's finger.
  template <typename Record>
  [[nodiscard]] RosHeader header_of(const Record& record) const {
    return {nanoseconds(record.time), name_of(record)};
  }

  void put(std::uint16_t channel, std::uint64_t time, CdrWriter message) {
    mcap_.write(channel, time, message.bytes());
  }

  void write(const StepRecord& step) {
    const RosHeader header = header_of(step);
    const RosHeader world{header.time, "world"};
    std::vector<RosTransform> transforms{{world, header.frame, step.X_WF}};
    if (step.tracked.valid) {
      transforms.push_back({world, header.frame + "_tracked", step.tracked.X_WFt});
    }
    put(tf_, header.time, tf_message(transforms));

    const Vector3 force_F = step.normal_force * step.mean_normal_F + step.tangential_force_F;
    put(wrench_, header.time, wrench_stamped(header, force_F, step.centroid_F.cross(force_F)));
    if (skin_) put(*skin_, header.time, point_cloud(header, skin_of(step)));
  }

  [[nodiscard]] std::vector<RosSkinPoint> skin_of(const StepRecord& step) const {
    const std::vector<double> pressures = skin_pressures(finger_of(step).model.get(), step.samples);
    std::vector<RosSkinPoint> points;
    points.reserve(pressures.size());
    for (std::size_t i = 0; i < pressures.size(); ++i) {
      const SampleRecord& sample = step.samples[i];
      points.push_back({sample.position_F, pressures[i], sample.in_contact != 0.0});
    }
    return points;
  }

  void write(const TickRecord& tick) {
    const RosHeader header = header_of(tick);
    const Configuration& q = tick.command.configuration;
    const Device* const device = finger_of(tick).device.get();
    if (device != nullptr && q.size() == device->degrees_of_freedom()) {
      const RosTransform platform{header, header.frame + "_platform",
                                  StoredPose(device->surface_pose(q))};
      put(tf_, header.time, tf_message({&platform, 1}));
    }
    const auto& names = joint_names_[static_cast<std::size_t>(tick.finger)];
    const JointAngles& joints = tick.command.joints;
    if (joints_ && static_cast<std::size_t>(joints.size()) == names.size()) {
      put(*joints_, header.time,
          joint_state(header, names, {joints.data(), static_cast<std::size_t>(joints.size())}));
    }
  }

  /// Those whose first row has nodes: a topic each.
  void add_soft_objects() {
    if (!reader_.info().with_state) return;
    ObjectRecord record;
    const RosType type = point_cloud_type();
    while (reader_.next(record) && record.step == 0) {
      if (record.nodes_W.empty()) continue;
      nodes_[record.object] =
          mcap_.add_channel("/" + frame_of(record) + "/nodes", type.name, type.schema);
    }
    reader_.rewind();
  }

  [[nodiscard]] std::string frame_of(const ObjectRecord& record) const {
    return "object_" + reader_.info().object_names[static_cast<std::size_t>(record.object)];
  }

  /// What objects did up to this step.
  void write_objects_until(std::int64_t step) {
    for (; mcap_.ok() && more_objects_ && object_.step <= step;
         more_objects_ = reader_.next(object_)) {
      write(object_);
    }
    for (; mcap_.ok() && more_events_ && event_.step <= step; more_events_ = reader_.next(event_)) {
      const std::uint64_t at = nanoseconds(event_.time);
      put(events_, at, log_line(at, words_of(event_)));
    }
  }

  void write(const ObjectRecord& record) {
    const RosHeader world{nanoseconds(record.time), "world"};
    const std::string frame = frame_of(record);
    const RosTransform transform{world, frame, record.X_WO};
    put(tf_, world.time, tf_message({&transform, 1}));
    if (joints_ && !std::isnan(record.joint)) {
      put(*joints_, world.time, joint_state(world, {&frame, 1}, {&record.joint, 1}));
    }
    if (const auto nodes = nodes_.find(record.object); nodes != nodes_.end()) {
      put(nodes->second, world.time, point_cloud(world, record.nodes_W));
    }
  }

  [[nodiscard]] std::string words_of(const EventRecord& event) const {
    const RecordingInfo& info = reader_.info();
    const auto name = [&](std::int64_t number) {
      const auto index = static_cast<std::size_t>(number);
      const std::size_t objects = info.object_names.size();
      return index < objects ? info.object_names[index] : info.fingers[index - objects].name;
    };
    std::string words = fmt::format("{}: {}", kEventKinds[static_cast<std::size_t>(event.kind)],
                                    name(event.object));
    if (event.other >= 0) words += " and " + name(event.other);
    if (!std::isnan(event.impulse)) words += fmt::format(", {:.3g} N s", event.impulse);
    return words;
  }

  /// What people were told before this step was taken.
  void tell_until(double time) {
    for (; told_ < messages_.size() && messages_[told_].time < time; ++told_) {
      const std::uint64_t at = nanoseconds(messages_[told_].time);
      put(events_, at, log_line(at, messages_[told_].text));
    }
  }

  RecordingReader& reader_;
  RecordedFingers recorded_;
  std::vector<RecordedMessage> messages_;
  std::size_t told_ = 0;
  ObjectRecord object_;  ///< the next, where there is one
  EventRecord event_;
  bool more_objects_ = false, more_events_ = false;
  McapWriter mcap_;
  std::uint16_t tf_ = 0, wrench_ = 0, events_ = 0;
  std::optional<std::uint16_t> joints_, skin_;
  std::map<std::int64_t, std::uint16_t> nodes_;        ///< topics of soft objects
  std::vector<std::vector<std::string>> joint_names_;  ///< of each finger
};

}  // namespace

Exported export_mcap(RecordingReader& reader, FileBeside& file) {
  return RosExport(reader, file).write();
}

}  // namespace softfinger
