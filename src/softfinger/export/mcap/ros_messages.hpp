#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/export/mcap/cdr_writer.hpp"
#include "softfinger/recording/record.hpp"

namespace softfinger {

/// A type of ROS 2 messages: its name, and its definition in the language of .msg files with those
/// of the types that it has in it.
struct RosType {
  std::string_view name;
  std::string schema;
};
[[nodiscard]] RosType tf_message_type();      ///< tf2_msgs/msg/TFMessage
[[nodiscard]] RosType joint_state_type();     ///< sensor_msgs/msg/JointState
[[nodiscard]] RosType wrench_stamped_type();  ///< geometry_msgs/msg/WrenchStamped
[[nodiscard]] RosType point_cloud_type();     ///< sensor_msgs/msg/PointCloud2
[[nodiscard]] RosType log_type();             ///< rcl_interfaces/msg/Log

/// Time, ns since the start of the run, and the frame of what the message says.
struct RosHeader {
  std::uint64_t time = 0;
  std::string frame;
};

struct RosTransform {
  RosHeader header;  ///< the parent's frame
  std::string child;
  StoredPose pose;  ///< of the child in the parent, m
};

/// A point of a skin.
struct RosSkinPoint {
  Vector3 position = Vector3::Zero();  ///< m
  double pressure = 0.0;               ///< Pa
  bool contact = false;
};

[[nodiscard]] CdrWriter tf_message(std::span<const RosTransform> transforms);
/// rad, or m of joints that slide.
[[nodiscard]] CdrWriter joint_state(const RosHeader& header, std::span<const std::string> names,
                                    std::span<const double> positions);
/// N, N m.
[[nodiscard]] CdrWriter wrench_stamped(const RosHeader& header, const Vector3& force,
                                       const Vector3& torque);
/// Fields x, y, z, pressure (64-bit floats) and contact (a byte, 1: in contact).
[[nodiscard]] CdrWriter point_cloud(const RosHeader& header,
                                    const std::vector<RosSkinPoint>& points);
/// Fields x, y, z (64-bit floats), m.
[[nodiscard]] CdrWriter point_cloud(const RosHeader& header, std::span<const Vector3> positions);
/// Of level INFO.
[[nodiscard]] CdrWriter log_line(std::uint64_t time, std::string_view text);

}  // namespace softfinger
