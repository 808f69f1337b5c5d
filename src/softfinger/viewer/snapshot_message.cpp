#include "softfinger/viewer/snapshot_message.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

#include "softfinger/base/units.hpp"
#include "softfinger/recording/record_fields.hpp"

namespace softfinger {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) { bytes_.clear(); }

  template <typename T>
  void put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void count(std::size_t value) { put(static_cast<std::uint32_t>(value)); }
  void real(double value) { put(static_cast<float>(value)); }
  void pose(const Pose& pose) {
    for (const double coordinate : pose.translation) real(coordinate / mm);
    const Eigen::Quaterniond turn(pose.rotation);
    for (const double part : turn.coeffs()) real(part);
  }
  void point(const Eigen::Vector3f& point) {
    for (const float coordinate : point) real(double{coordinate} / mm);
  }
  void text(std::string_view text, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) put(i < text.size() ? text[i] : '\0');
  }
  void pad() {
    while (bytes_.size() % 4 != 0) put(std::uint8_t{0});
  }

 private:
  std::vector<std::byte>& bytes_;
};

std::size_t sample_count(const Snapshot::Skin& skin) {
  return std::min({skin.positions_F.size(), skin.pressures.size(), skin.in_contact.size()});
}

void write_skin(const Snapshot::Skin& skin, std::size_t samples, Writer& out) {
  for (std::size_t i = 0; i < samples; ++i) out.point(skin.positions_F[i]);
  for (std::size_t i = 0; i < samples; ++i) out.real(double{skin.pressures[i]} / kPa);
  for (std::size_t i = 0; i < samples; ++i) out.put(skin.in_contact[i]);
  out.pad();
}

void write_twin(const Snapshot::Twin& twin, std::size_t samples, Writer& out) {
  out.real(twin.measures.iou);
  out.real(twin.measures.centroid_shift / mm);
  out.real(twin.measures.normal_angle / deg);
  out.real(twin.measures.normal_force_error);
  out.real(twin.measures.normal_force_bias);
  out.real(twin.normal_force);
  out.real(twin.contact_area / mm2);
  out.real(twin.cpu_time / ms);
  out.real(twin.normal_force_sum);
  out.real(twin.tangential_force);
  out.real(twin.measures.tangential_force_error);
  out.real(twin.measures.slip_ratio_error);
  write_skin(twin.skin, samples, out);
}

void write_finger(const Snapshot::Finger& finger, const SceneDescription::Finger& description,
                  Writer& out) {
  const std::vector<std::string>& names = description.configuration_names;
  out.pose(finger.X_WFt);
  out.pose(finger.X_WF);
  out.pose(finger.X_FP);
  for_each_live_field(finger, [&](std::string_view, double value) { out.real(value); });
  out.real(finger.deviation / mm2);
  out.put(static_cast<std::uint32_t>(finger.tick));
  for (const double stage : finger.stages.all()) out.real(stage / ms);
  out.real(finger.device_said / ms);

  const std::size_t samples = sample_count(finger.skin);
  const std::size_t twin_samples = finger.twin.pressed ? sample_count(finger.twin.skin) : 0;
  out.count(samples);
  out.count(static_cast<std::size_t>(finger.configuration.size()));
  out.count(static_cast<std::size_t>(finger.joints.size()));
  out.count(finger.linkage_F.size());
  out.count(finger.pieces.size());
  out.count(twin_samples);
  out.count(static_cast<std::size_t>(finger.actual.size()));
  out.put((finger.force_limited ? 1U : 0U) | static_cast<std::uint32_t>(finger.objective) << 8U);
  out.text(std::string_view(finger.device_state).substr(0, 15), 16);

  write_skin(finger.skin, samples, out);
  for (const Configuration* q : {&finger.configuration, &finger.actual}) {
    for (Eigen::Index i = 0; i < q->size(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      out.real((*q)[i] / (index < names.size() ? unit_scale(names[index]) : 1.0));
    }
  }
  for (const double joint : finger.joints) {
    out.real(joint / (description.linear_joints ? mm : deg));
  }
  for (const Eigen::Vector3f& point : finger.linkage_F) out.point(point);
  for (const Snapshot::Piece& piece : finger.pieces) {
    out.pose(piece.X_FS);
    out.real(piece.ball_radius / mm);
  }
  if (twin_samples > 0) write_twin(finger.twin, twin_samples, out);
}

}  // namespace

void write_snapshot_message(const Snapshot& snapshot, const SceneDescription& scene,
                            std::vector<std::byte>& message) {
  Writer out(message);
  out.put(kSnapshotMagic);
  out.put(static_cast<std::uint32_t>(snapshot.generation));
  out.put(static_cast<std::uint32_t>(snapshot.step));
  out.put(static_cast<std::uint32_t>((snapshot.paused ? 1U : 0U) | (snapshot.finished ? 2U : 0U) |
                                     (snapshot.stopped.asked ? 4U : 0U) |
                                     (snapshot.stopped.confirmed ? 8U : 0U)));
  out.put(snapshot.time);
  out.real(snapshot.step_cpu_time / ms);
  out.real(snapshot.match_cpu_time / ms);
  out.put(static_cast<std::uint32_t>(snapshot.deadline_misses));
  out.count(snapshot.X_WO.size());
  out.count(snapshot.fingers.size());
  out.put(static_cast<std::uint32_t>(static_cast<std::uint64_t>(snapshot.wall_time / ms)));
  out.put(snapshot.stops);
  out.count(snapshot.soft_objects.size());
  for (const Pose& X_WO : snapshot.X_WO) out.pose(X_WO);
  for (std::size_t i = 0; i < snapshot.fingers.size(); ++i) {
    static const SceneDescription::Finger kUnknown;
    write_finger(snapshot.fingers[i], i < scene.fingers.size() ? scene.fingers[i] : kUnknown, out);
  }
  for (const Snapshot::SoftObject& soft : snapshot.soft_objects) {
    out.count(soft.object);
    out.count(soft.positions_O.size());
    for (const Eigen::Vector3f& point : soft.positions_O) out.point(point);
  }
}

}  // namespace softfinger
