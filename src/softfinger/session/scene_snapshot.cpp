#include "softfinger/session/scene_snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

/// Triangles of one named surface, over indices into the vertices collected so far.
class SurfaceCollector {
 public:
  SurfaceCollector(const TetrahedralMesh& mesh, std::vector<Vector3>& positions)
      : mesh_(mesh), positions_(positions) {}

  std::vector<std::array<int, 3>> collect(const char* surface) {
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto name = static_cast<std::size_t>(mesh_.triangle_surface[t]);
      if (mesh_.surface_names[name] != surface) continue;
      std::array<int, 3> triangle{};
      for (std::size_t i = 0; i < 3; ++i) triangle[i] = index_of(mesh_.triangles[t][i]);
      triangles.push_back(triangle);
    }
    return triangles;
  }

 private:
  int index_of(int node) {
    const auto [entry, added] = indices_.try_emplace(node, static_cast<int>(positions_.size()));
    if (added) positions_.push_back(mesh_.nodes[static_cast<std::size_t>(node)]);
    return entry->second;
  }

  const TetrahedralMesh& mesh_;
  std::vector<Vector3>& positions_;
  std::map<int, int> indices_;
};

/// Of what can be touched, at rest.
std::vector<Vector3> touching_nodes(const SoftSolid& solid) {
  std::vector<Vector3> positions;
  for (const int node : solid.sample_nodes) {
    positions.push_back(solid.mesh.nodes[static_cast<std::size_t>(node)]);
  }
  return positions;
}

}  // namespace

DeviceFeedback initial_feedback(const DeviceLoop& device) {
  DeviceFeedback feedback;
  feedback.linkage_F.resize(static_cast<std::size_t>(3 * device.device().leg_count()));
  feedback.pieces.resize(static_cast<std::size_t>(device.device().solid_piece_count()));
  read_device(device, feedback);
  return feedback;
}

void read_device(const DeviceLoop& device, DeviceFeedback& feedback) {
  feedback.tick = device.record();
  const Configuration& q = feedback.tick.command.configuration;
  feedback.X_FP = device.device().surface_pose(q);
  if (!feedback.linkage_F.empty()) device.device().linkage(q, feedback.linkage_F);
  device.device().solid_pieces(q, feedback.pieces);
  JointAngles joints;
  const bool known = device.actuator().read_servo_joints(joints) &&
                     device.device().forward_kinematics(joints, feedback.actual);
  if (!known) feedback.actual.resize(0);
  feedback.state = device.actuator().state();
}

SceneDescription describe(const RunSetup& setup) {
  SceneDescription description;
  description.scene_name = setup.scene.file.stem().string();
  for (const ObjectiveKind& kind : objective_kinds()) {
    description.objectives.push_back({std::string(kind.name), std::string(kind.words)});
  }
  for (const VirtualObject& object : setup.scene.objects) {
    SceneDescription::Object& told = description.objects.emplace_back();
    told.name = object.name;
    told.shape = object.shape;
    told.can_be_held = object.can_be_held();
    if (object.dynamics && object.dynamics->joint) {
      told.joint = row_of(kJointKinds, object.dynamics->joint->kind).name;
    }
    if (object.hand() >= 0) {
      told.hand = setup.scene.hands[static_cast<std::size_t>(object.hand())].name;
    }
    if (!object.soft) continue;
    told.positions_O = touching_nodes(*object.soft);
    told.triangles = object.soft->skin_triangles;
  }
  for (std::size_t i = 0; i < setup.scene.fingers.size(); ++i) {
    const FingerModel& model = *setup.models[i];
    SceneDescription::Finger finger;
    finger.name = setup.scene.fingers[i].name;
    const TrackerSpec tracker = parse_tracker_spec(setup.scene.fingers[i].tracker);
    finger.moved_here = tracker.kind == TrackerKind::kPage;
    finger.in_headset = tracker.kind == TrackerKind::kWebXr;
    finger.hand_side = tracker.hand.side;
    finger.hand_finger = tracker.hand.finger.value_or(HandFinger::kIndex);
    finger.registrable = is_registrable(setup, i);
    finger.fittable = is_fittable(setup, i);
    finger.fits_by_touch = finger.fittable && !setup.devices[i]->settings().force_sensor;
    finger.X_WFt_start = start_pose(setup.scene.fingers[i].waypoints);
    finger.skin_rest_positions_F = touching_nodes(model);
    finger.skin_triangles = model.skin_triangles;
    SurfaceCollector surfaces(model.mesh, finger.rigid_positions_F);
    finger.bone_triangles = surfaces.collect("bone");
    finger.nail_triangles = surfaces.collect("nail");
    if (const Device* device = setup.devices[i].get()) {
      const DeviceKind& kind = device_kind(device->kind());
      finger.device_kind = kind.name;
      finger.device_kind_words = kind.words;
      finger.cables = kind.cables;
      for (const ConfigurationAxis& axis : device->axes()) {
        finger.configuration_names.push_back(axis.name);
      }
      for (const ObjectiveKind& objective : objective_kinds()) {
        if (!why_not(objective, *device).empty()) continue;
        finger.objectives.push_back(static_cast<int>(number_of(objective)));
      }
      finger.linear_joints = device->joint_limits().linear;
      finger.disk_radius = device->disk_radius();
      finger.legs = device->leg_count();
      std::vector<SolidPiece> pieces(static_cast<std::size_t>(device->solid_piece_count()));
      device->solid_pieces(device->home(), pieces);
      for (const SolidPiece& piece : pieces) finger.pieces.push_back(piece.shape);
      finger.cap_radius = device->cap_radius();
      finger.workspace = device->workspace_outline();
    }
    description.fingers.push_back(std::move(finger));
    for (const DeviceNotice& notice : setup.notices[description.fingers.size() - 1]) {
      description.notices.push_back({description.fingers.size() - 1, notice.key, notice.text});
    }
  }
  return description;
}

Snapshot initial_snapshot(const RunSetup& setup) {
  Snapshot snapshot;
  const std::vector<VirtualObject>& objects = setup.scene.objects;
  snapshot.X_WO.resize(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].soft) continue;
    Snapshot::SoftObject& soft = snapshot.soft_objects.emplace_back();
    soft.object = i;
    for (const Vector3& at : touching_nodes(*objects[i].soft)) {
      soft.positions_O.push_back(at.cast<float>());
    }
  }
  for (std::size_t i = 0; i < setup.models.size(); ++i) {
    Snapshot::Finger finger;
    const FingerModel& model = *setup.models[i];
    const std::size_t samples = model.sample_nodes.size();
    for (const Vector3& rest : touching_nodes(model)) {
      finger.skin.positions_F.push_back(rest.cast<float>());
    }
    finger.skin.pressures.resize(samples);
    finger.skin.in_contact.resize(samples);
    if (const Device* device = setup.devices[i].get()) {
      finger.linkage_F.assign(static_cast<std::size_t>(3 * device->leg_count()),
                              Eigen::Vector3f::Zero());
      finger.pieces.resize(static_cast<std::size_t>(device->solid_piece_count()));
    }
    snapshot.fingers.push_back(std::move(finger));
  }
  return snapshot;
}

void fill(Snapshot::SoftObject& snapshot, const SoftSolid& solid, const Pose& X_WO,
          std::span<const Vector3> nodes) {
  const Pose X_OW = X_WO.inverse();
  const std::size_t samples = std::min(solid.sample_nodes.size(), snapshot.positions_O.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const Vector3& at = nodes[static_cast<std::size_t>(solid.sample_nodes[i])];
    snapshot.positions_O[i] = (X_OW * at).cast<float>();
  }
}

void fill(Snapshot::Skin& snapshot, const ContactSet& contact) {
  const std::size_t samples = std::min(contact.samples.size(), snapshot.in_contact.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const ContactSample& sample = contact.samples[i];
    snapshot.positions_F[i] = sample.position_F.cast<float>();
    snapshot.pressures[i] = static_cast<float>(sample.pressure());
    snapshot.in_contact[i] = sample.touched() > 0.0 ? 1 : 0;
  }
}

void fill(Snapshot::Finger& snapshot, const FingerLoop& loop) {
  const ContactSet& contact = loop.contact();
  snapshot.X_WFt = loop.record().tracked.X_WFt.pose();
  snapshot.tracked = loop.record().tracked.valid;
  snapshot.tracked_time = loop.record().tracked.time;
  snapshot.X_WF = loop.simulation().bone_pose();
  fill(snapshot.skin, contact);
  snapshot.sums() = contact.sums();
}

void fill(Snapshot::Finger& snapshot, const DeviceFeedback& feedback) {
  snapshot.deviation = feedback.tick.deviation;
  snapshot.configuration = feedback.tick.command.configuration;
  snapshot.actual = feedback.actual;
  snapshot.joints = feedback.tick.command.joints;
  snapshot.tick = feedback.tick.tick;
  const double objective = feedback.tick.objective;
  snapshot.objective = std::isnan(objective) ? 0 : static_cast<int>(objective);
  snapshot.stages = feedback.tick.stages;
  snapshot.X_FP = feedback.X_FP;
  const std::size_t points = std::min(snapshot.linkage_F.size(), feedback.linkage_F.size());
  for (std::size_t i = 0; i < points; ++i) {
    snapshot.linkage_F[i] = feedback.linkage_F[i].cast<float>();
  }
  const std::size_t pieces = std::min(snapshot.pieces.size(), feedback.pieces.size());
  for (std::size_t k = 0; k < pieces; ++k) {
    const auto* ball = std::get_if<Ball>(&feedback.pieces[k].shape);
    snapshot.pieces[k] = {feedback.pieces[k].X_FS, ball != nullptr ? ball->radius : 0.0};
  }
  snapshot.device_state = state_name(feedback.state);
  snapshot.force_limited = feedback.tick.command.force_limited;
}

}  // namespace softfinger
