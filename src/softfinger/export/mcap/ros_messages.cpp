#include "softfinger/export/mcap/ros_messages.hpp"

#include <fmt/format.h>

#include <array>

namespace softfinger {
namespace {

// Definitions, as the packages common_interfaces, geometry2 and rcl_interfaces of ROS 2 have them.
constexpr std::string_view kTime = "int32 sec\nuint32 nanosec\n";
constexpr std::string_view kHeaderFields = "builtin_interfaces/Time stamp\nstring frame_id\n";
constexpr std::string_view kVector3 = "float64 x\nfloat64 y\nfloat64 z\n";
constexpr std::string_view kQuaternion = "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
constexpr std::string_view kTransform =
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n";
constexpr std::string_view kTransformStamped =
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n";
constexpr std::string_view kWrench = "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n";
constexpr std::string_view kPointField =
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
    "uint8 FLOAT32=7\nuint8 FLOAT64=8\n"
    "string name\nuint32 offset\nuint8 datatype\nuint32 count\n";

constexpr std::uint8_t kUint8 = 2, kFloat64 = 8;  // of PointField
constexpr std::uint8_t kInfo = 20;                // of Log

struct Definition {
  std::string_view type, fields;
};

/// The fields of a type, then the types that it has in it.
std::string schema_of(std::string_view fields, std::initializer_list<Definition> others) {
  std::string schema(fields);
  for (const Definition& other : others) {
    fmt::format_to(std::back_inserter(schema), "{:=<80}\nMSG: {}\n{}", "", other.type,
                   other.fields);
  }
  return schema;
}

constexpr Definition kTimeType{"builtin_interfaces/Time", kTime};
constexpr Definition kHeaderType{"std_msgs/Header", kHeaderFields};
constexpr Definition kVectorType{"geometry_msgs/Vector3", kVector3};

void put_time(CdrWriter& cdr, std::uint64_t time) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  cdr.i32(static_cast<std::int32_t>(time / kSecond));
  cdr.u32(static_cast<std::uint32_t>(time % kSecond));
}

void put_header(CdrWriter& cdr, const RosHeader& header) {
  put_time(cdr, header.time);
  cdr.text(header.frame);
}

void put_vector(CdrWriter& cdr, const Vector3& vector) {
  for (const double value : vector) cdr.f64(value);
}

/// A field of a point, at so many bytes from its begin.
void put_field(CdrWriter& cdr, std::string_view name, std::uint32_t offset, std::uint8_t type) {
  cdr.text(name);
  cdr.u32(offset);
  cdr.u8(type);
  cdr.u32(1);
}

/// A cloud of one row whose points are these 64-bit floats, then perhaps a byte; `points` has them
/// one after the other.
CdrWriter cloud(const RosHeader& header, std::span<const char* const> numbers, const char* byte,
                std::uint32_t count, std::span<const std::uint8_t> points) {
  const auto size = static_cast<std::uint32_t>(8 * numbers.size());
  const std::uint32_t point = size + (byte != nullptr ? 1 : 0);  // bytes
  CdrWriter cdr;
  put_header(cdr, header);
  cdr.u32(1);  // row
  cdr.u32(count);
  cdr.count(numbers.size() + (byte != nullptr ? 1 : 0));
  for (std::uint32_t i = 0; i < numbers.size(); ++i) put_field(cdr, numbers[i], 8 * i, kFloat64);
  if (byte != nullptr) put_field(cdr, byte, size, kUint8);
  cdr.u8(0);  // little-endian
  cdr.u32(point);
  cdr.u32(point * count);
  cdr.count(points.size());
  cdr.append(points);
  cdr.u8(1);  // no point is missing
  return cdr;
}

}  // namespace

RosType tf_message_type() {
  return {"tf2_msgs/msg/TFMessage",
          schema_of("geometry_msgs/TransformStamped[] transforms\n",
                    {{"geometry_msgs/TransformStamped", kTransformStamped},
                     {"geometry_msgs/Transform", kTransform},
                     kVectorType,
                     {"geometry_msgs/Quaternion", kQuaternion},
                     kHeaderType,
                     kTimeType})};
}

RosType joint_state_type() {
  return {"sensor_msgs/msg/JointState",
          schema_of("std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                    "float64[] velocity\nfloat64[] effort\n",
                    {kHeaderType, kTimeType})};
}

RosType wrench_stamped_type() {
  return {"geometry_msgs/msg/WrenchStamped",
          schema_of("std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
                    {{"geometry_msgs/Wrench", kWrench}, kVectorType, kHeaderType, kTimeType})};
}

RosType point_cloud_type() {
  return {"sensor_msgs/msg/PointCloud2",
          schema_of("std_msgs/Header header\nuint32 height\nuint32 width\n"
                    "sensor_msgs/PointField[] fields\nbool is_bigendian\nuint32 point_step\n"
                    "uint32 row_step\nuint8[] data\nbool is_dense\n",
                    {{"sensor_msgs/PointField", kPointField}, kHeaderType, kTimeType})};
}

RosType log_type() {
  return {"rcl_interfaces/msg/Log",
          schema_of("byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n"
                    "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\n"
                    "string file\nstring function\nuint32 line\n",
                    {kTimeType})};
}

CdrWriter tf_message(std::span<const RosTransform> transforms) {
  CdrWriter cdr;
  cdr.count(transforms.size());
  for (const RosTransform& transform : transforms) {
    put_header(cdr, transform.header);
    cdr.text(transform.child);
    put_vector(cdr, transform.pose.translation);
    for (const double value : transform.pose.rotation.coeffs()) cdr.f64(value);  // x, y, z, w
  }
  return cdr;
}

CdrWriter joint_state(const RosHeader& header, std::span<const std::string> names,
                      std::span<const double> positions) {
  CdrWriter cdr;
  put_header(cdr, header);
  cdr.count(names.size());
  for (const std::string& name : names) cdr.text(name);
  cdr.count(positions.size());
  for (const double position : positions) cdr.f64(position);
  cdr.count(0);  // velocities
  cdr.count(0);  // efforts
  return cdr;
}

CdrWriter wrench_stamped(const RosHeader& header, const Vector3& force, const Vector3& torque) {
  CdrWriter cdr;
  put_header(cdr, header);
  put_vector(cdr, force);
  put_vector(cdr, torque);
  return cdr;
}

CdrWriter point_cloud(const RosHeader& header, const std::vector<RosSkinPoint>& points) {
  constexpr std::array kNumbers{"x", "y", "z", "pressure"};
  ByteWriter data;
  for (const RosSkinPoint& point : points) {
    for (const double value : point.position) data.f64(value);
    data.f64(point.pressure);
    data.u8(point.contact ? 1 : 0);
  }
  return cloud(header, kNumbers, "contact", static_cast<std::uint32_t>(points.size()),
               data.bytes());
}

CdrWriter point_cloud(const RosHeader& header, std::span<const Vector3> positions) {
  constexpr std::array kNumbers{"x", "y", "z"};
  ByteWriter data;
  for (const Vector3& position : positions) {
    for (const double value : position) data.f64(value);
  }
  return cloud(header, kNumbers, nullptr, static_cast<std::uint32_t>(positions.size()),
               data.bytes());
}

CdrWriter log_line(std::uint64_t time, std::string_view text) {
  CdrWriter cdr;
  put_time(cdr, time);
  cdr.u8(kInfo);
  cdr.text("softfinger");
  cdr.text(text);
  cdr.text("");  // file
  cdr.text("");  // function
  cdr.u32(0);    // line
  return cdr;
}

}  // namespace softfinger
