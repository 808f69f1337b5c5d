#include "softfinger/scene/hand_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "softfinger/geometry/mass_properties.hpp"
#include "softfinger/scene/pose_keys.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

const Range kJointAngle = Range::between(-180.0, 180.0);  // deg
const Range kHandSize = Range::between(0.5, 2.0);         // times an adult's
const Range kPullLimit = Range::between(0.1, 1000.0);     // N
const Range kHandFriction = Range::between(0.0, 10.0);
constexpr double kUsualPullLimit = 20.0;  // N
constexpr std::size_t kMostHands = 2;

constexpr double kFleshDensity = 1100.0;   ///< of bone and flesh together, kg/m^3
constexpr double kFoundation = 1e7;        ///< of flesh, N/m^3
constexpr double kPullStiffness = 2000.0;  ///< of what pulls a bone, N/m

HandAngles read_angles(const ConfigTable& table) {
  HandAngles angles;
  for (std::size_t f = 0; f < kHandFingers.size(); ++f) {
    angles[f] = table.numbers(fmt::format("{}_deg", kHandFingers[f].name), 3, kJointAngle,
                              Vector3(Vector3::Zero()));
  }
  return angles;
}

std::vector<HandWaypoint> read_hand_waypoints(const ConfigTable& owner) {
  std::vector<HandWaypoint> waypoints;
  const std::vector<Waypoint> places = read_waypoints(owner, nullptr);
  const std::vector<ConfigTable> tables = owner.tables("waypoint");
  for (std::size_t k = 0; k < places.size(); ++k) {
    waypoints.push_back({places[k].time, places[k].pose, read_angles(tables[k])});
  }
  return waypoints;
}

ReadHand read_hand(const ConfigTable& table) {
  ReadHand read{.table = table, .hand = {}, .friction_coefficient = {}};
  SceneHand& hand = read.hand;
  const std::string side =
      table.choice("side", names_of(kHandSides), std::string(name_of(HandSide::kRight)));
  hand.side = row_named(kHandSides, side)->value;
  hand.name = table.text("name", side);
  table.matches("name", kFingerNamePattern);
  if (!is_finger_name(hand.name)) {
    table.fail("name", "expected 1 to 64 letters, digits, - or _");
  }
  const std::string script(row_of(kTrackers, TrackerKind::kScript).name);
  const std::string headset(row_of(kTrackers, TrackerKind::kWebXr).name);
  const std::string tracker = table.choice("tracker", {script, headset}, script);
  read.size = table.number("size", kHandSize, 1.0);
  read.force_limit = table.number("force_limit_N", kPullLimit, kUsualPullLimit);
  read.friction_coefficient = table.optional_number("friction_coefficient", kHandFriction);
  const std::vector<HandWaypoint> waypoints = read_hand_waypoints(table);
  if (tracker == headset) return read;
  if (waypoints.empty()) {
    table.finish();  // a misspelt key may be the reason
    table.fail("tracker", "tracker script needs at least one [[hand.waypoint]]");
  }
  hand.script.emplace(hand.side, read.size, waypoints);
  return read;
}

/// A bone of the hand, held at X_WO at the start.
VirtualObject bone_of(const ReadHand& read, int hand, std::size_t piece, const Pose& X_WO) {
  const HandPiece& from = kHandPieces.at(piece);
  const TaperedCapsule capsule{read.size * from.back, read.size * from.front,
                               0.5 * read.size * from.length};
  const double mass = kFleshDensity * mass_properties(capsule)->volume;
  // Both ends go about as far by a torque as by a force there.
  const double arm = capsule.half_length * capsule.half_length;
  const double damping = 2.0 * std::sqrt(kPullStiffness * mass);
  VirtualObject bone{.name = fmt::format("{}-{}-{}", read.hand.name, name_of(from.finger),
                                         row_of(kHandBones, from.bone).name),
                     .shape = capsule,
                     .motion = Trajectory(X_WO),
                     .friction_coefficient = read.friction_coefficient};
  bone.dynamics.emplace().mass = mass;
  bone.dynamics->following = {.hand = hand,
                              .stiffness = kPullStiffness,
                              .damping = damping,
                              .rotation_stiffness = arm * kPullStiffness,
                              .rotation_damping = arm * damping,
                              .force_limit = read.force_limit,
                              .torque_limit = capsule.half_length * read.force_limit,
                              .foundation = kFoundation};
  return bone;
}

}  // namespace

std::vector<ReadHand> read_hands(const std::vector<ConfigTable>& tables) {
  std::vector<ReadHand> read;
  std::set<std::string> names;
  for (const ConfigTable& table : tables) {
    read.push_back(read_hand(table));
    if (!names.insert(read.back().hand.name).second) {
      table.fail("name", fmt::format("two hands are named '{}'", read.back().hand.name));
    }
    if (read.size() > kMostHands) {
      table.fail("side", fmt::format("more than {} hands", kMostHands));
    }
  }
  return read;
}

void read_hand_of(const ConfigTable& table, const std::vector<ReadHand>& hands,
                  SceneFinger& finger) {
  const auto name = table.optional_text("hand");
  if (!name) return;
  const auto found =
      std::ranges::find(hands, *name, [](const ReadHand& read) { return read.hand.name; });
  if (found == hands.end()) table.fail("hand", fmt::format("no hand is named '{}'", *name));
  const auto part = parse_hand_part(finger.name);
  if (!part || !part->finger) {
    table.fail("name", fmt::format("'{}' is no finger of a hand; one is called thumb, index, "
                                   "middle, ring or pinky, or as in left-thumb",
                                   finger.name));
  }
  finger.hand = static_cast<int>(found - hands.begin());
  finger.hand_finger = *part->finger;
  finger.hand_script = found->hand.script;
  if (!found->hand.script && !table.has("tracker")) {
    finger.tracker = fmt::format("{}:{}-{}", row_of(kTrackers, TrackerKind::kWebXr).name,
                                 name_of(found->hand.side), name_of(finger.hand_finger));
  }
}

void add_hands(const std::vector<ReadHand>& read, Scene& scene) {
  for (const ReadHand& each : read) {
    SceneHand& hand = scene.hands.emplace_back(each.hand);
    hand.first_object = scene.objects.size();
    const HandPose start = hand.script ? hand.script->sample(0.0) : HandPose{};
    for (std::size_t p = 0; p < kHandPieces.size(); ++p) {
      VirtualObject bone =
          bone_of(each, static_cast<int>(scene.hands.size() - 1), p, start.pieces.at(p));
      if (std::ranges::find(scene.objects, bone.name, &VirtualObject::name) !=
          scene.objects.end()) {
        each.table.fail("name", fmt::format("its bone '{}' is called as an object is; name the "
                                            "hand or the object otherwise",
                                            bone.name));
      }
      scene.objects.push_back(std::move(bone));
    }
    if (!hand.script) leave_to_headset(scene, scene.hands.size() - 1);
  }
}

void leave_to_headset(Scene& scene, std::size_t hand) {
  scene.hands[hand].script.reset();
  for (VirtualObject& object : scene.objects) {
    if (object.hand() != static_cast<int>(hand)) continue;
    object.motion = Trajectory(Pose{Matrix3::Identity(), kNowhere});
  }
}

std::unique_ptr<Tracker> SceneFinger::make_tracker(const std::filesystem::path& directory) const {
  if (hand_script && waypoints.empty() &&
      parse_tracker_spec(tracker).kind == TrackerKind::kScript) {
    return std::make_unique<HandScriptTracker>(*hand_script, hand_finger);
  }
  std::vector<Waypoint> places = waypoints;
  if (places.empty() && hand_script) {
    places.push_back(
        {0.0, hand_script->sample(0.0).distal.at(static_cast<std::size_t>(hand_finger))});
  }
  return softfinger::make_tracker(tracker, directory, places);
}

}  // namespace softfinger
