#include "synthetic_feed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

struct Surface {
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> triangles;
};

Surface unit_sphere(int subdivisions) {
  Surface sphere;
  for (const double sign : {1.0, -1.0}) {
    sphere.points.emplace_back(sign, 0, 0);
    sphere.points.emplace_back(0, sign, 0);
    sphere.points.emplace_back(0, 0, sign);
  }
  sphere.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                      {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), 0);
      if (is_new) {
        at->second = static_cast<int>(sphere.points.size());
        sphere.points.push_back((sphere.points[static_cast<std::size_t>(a)] +
                                 sphere.points[static_cast<std::size_t>(b)])
                                    .normalized());
      }
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : sphere.triangles) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    sphere.triangles = std::move(finer);
  }
  return sphere;
}

Vector3 pad_point(const Vector3& p) {
  return {p.x() * (p.x() > 0 ? 12.5 : 11.5) * mm, p.y() * 8.0 * mm, p.z() * 6.7 * mm};
}

/// Splits the ellipsoid into skin and nail, adds a bone.
SceneDescription::Finger make_finger(const std::string& name) {
  SceneDescription::Finger finger;
  finger.name = name;
  finger.registrable = true;
  finger.fittable = true;
  finger.device_kind = "platform_3rrs";
  finger.device_kind_words = "3-RRS thimble";
  finger.configuration_names = {"pitch_deg", "roll_deg", "travel_mm"};
  finger.objectives = {0, 1};
  finger.disk_radius = 8 * mm;
  finger.legs = 3;
  finger.pieces = {RoundedCylinder{8 * mm, 1 * mm, 0.5 * mm}};
  finger.workspace.pitch_axis = 0;
  finger.workspace.roll_axis = 1;
  finger.workspace.travel_axis = 2;
  for (const double travel : {-4 * mm, 2 * mm, 8 * mm}) {
    const double tilt = 28 * deg - std::abs(travel - 2 * mm) * (20 * deg) / (6 * mm);
    finger.workspace.tilt_layers.push_back({travel, std::vector<double>(24, tilt)});
  }
  finger.twin = true;
  const Surface sphere = unit_sphere(3);
  std::map<int, int> skin_index;
  std::map<int, int> nail_index;
  const auto is_nail = [&](const std::array<int, 3>& triangle) {
    Vector3 middle = Vector3::Zero();
    for (const int i : triangle) middle += sphere.points[static_cast<std::size_t>(i)] / 3;
    return middle.z() > 0.62 && middle.x() > -0.15 && std::abs(middle.y()) < 0.6;
  };
  for (const auto& triangle : sphere.triangles) {
    const bool nail = is_nail(triangle);
    auto& points = nail ? finger.rigid_positions_F : finger.skin_rest_positions_F;
    std::array<int, 3> mapped{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = (nail ? nail_index : skin_index)
                                    .try_emplace(triangle[k], static_cast<int>(points.size()));
      if (is_new) points.push_back(pad_point(sphere.points[static_cast<std::size_t>(triangle[k])]));
      mapped[k] = at->second;
    }
    (nail ? finger.nail_triangles : finger.skin_triangles).push_back(mapped);
  }
  const auto first = static_cast<int>(finger.rigid_positions_F.size());
  for (const Vector3& p : sphere.points) {
    finger.rigid_positions_F.push_back(p.cwiseProduct(Vector3(8, 3.2, 2.4)) * mm +
                                       Vector3(-1.5, 0, 1) * mm);
  }
  for (const auto& [a, b, c] : sphere.triangles) {
    finger.bone_triangles.push_back({first + a, first + b, first + c});
  }
  return finger;
}

struct Platform {
  Pose X_FP;
  std::array<double, 3> joints{};
  std::vector<Eigen::Vector3f> linkage;
};

/// Inverse kinematics of the 3-RRS platform, elbows outward.
Platform platform_at(double pitch, double roll, double travel) {
  constexpr double kBaseRadius = 16 * mm;
  constexpr double kPlatformRadius = 12 * mm;
  constexpr double kCrank = 10 * mm;
  constexpr double kCoupler = 20 * mm;
  constexpr double kNeutralHeight = 24 * mm;
  const Vector3 mount(1 * mm, 0, -10 * mm);
  const Matrix3 M = exp_rotation(Vector3(roll, pitch, 0));
  const Vector3 centre(kPlatformRadius / 2 * (M(0, 0) - M(1, 1)), -kPlatformRadius * M(0, 1),
                       travel);
  Platform platform;
  platform.X_FP = {M, mount + centre};
  for (std::size_t i = 0; i < 3; ++i) {
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(i) / 3;
    const Vector3 u(std::cos(azimuth), std::sin(azimuth), 0);
    const Vector3 z = Vector3::UnitZ();
    const Vector3 end = centre + M * (kPlatformRadius * u) - kNeutralHeight * z;
    const double x = u.dot(end) - kBaseRadius;
    const double y = -z.dot(end);
    const double length = std::hypot(x, y);
    const double cosine =
        (kCrank * kCrank + length * length - kCoupler * kCoupler) / (2 * kCrank * length);
    platform.joints[i] = std::atan2(y, x) - std::acos(std::clamp(cosine, -1.0, 1.0));
    const Vector3 base = mount + kNeutralHeight * z + kBaseRadius * u;
    const Vector3 knee =
        base + kCrank * (std::cos(platform.joints[i]) * u - std::sin(platform.joints[i]) * z);
    for (const Vector3& p : {base, knee, Vector3(mount + kNeutralHeight * z + end)}) {
      platform.linkage.push_back(p.cast<float>());
    }
  }
  return platform;
}

double distance_to(const Shape& shape, const Vector3& p, Vector3& normal) {
  if (const auto* ball = std::get_if<Ball>(&shape)) {
    normal = p.normalized();
    return p.norm() - ball->radius;
  }
  if (const auto* box = std::get_if<RoundedBox>(&shape)) {
    const Vector3 inner = box->half_size.array() - box->edge_radius;
    const Vector3 outside = (p.cwiseAbs() - inner).cwiseMax(0);
    normal = outside.norm() > 0 ? Vector3(outside.cwiseProduct(p.cwiseSign()).normalized())
                                : Vector3::UnitZ();
    return outside.norm() > 0 ? outside.norm() - box->edge_radius
                              : std::abs(p.z()) - box->half_size.z();
  }
  normal = Vector3::UnitZ();
  return p.z();
}

/// Where a finger of the hand is over the table, m, and how far it is turned about the vertical.
struct Place {
  const char* finger;
  Vector3 position;
  double turn;
};
const std::array<Place, 5> kHand{{{"thumb", Vector3(-34, 44, 0) * mm, -40 * deg},
                                  {"index", Vector3(0, 22, 0) * mm, -4 * deg},
                                  {"middle", Vector3(6, 0, 0) * mm, 0.0},
                                  {"ring", Vector3(1, -21, 0) * mm, 3 * deg},
                                  {"pinky", Vector3(-14, -40, 0) * mm, 8 * deg}}};

}  // namespace

SyntheticFeed::SyntheticFeed() { start_scene("sphere"); }

std::shared_ptr<const SceneDescription> SyntheticFeed::description() { return description_; }

void SyntheticFeed::start_scene(const std::string& name) {
  auto scene = std::make_shared<SceneDescription>();
  scene->generation = snapshot_.generation + 1;
  scene->scene_name = name;
  scene->scene_names = {"corner", "cylinder", "edge", "hand", "plane", "relief", "sphere"};
  scene->duration = 12.0;
  scene->objectives = {{"surface", "contact surface"},
                       {"surface_and_force", "contact surface and force"}};
  X_WO_ = {};
  if (name == "sphere") {
    scene->objects.push_back({"ball", Ball{20 * mm}});
    X_WO_.translation.z() = -20 * mm;
  } else if (name == "edge") {
    scene->objects.push_back({"block", RoundedBox{Vector3(15, 20, 10) * mm, 1 * mm}});
    X_WO_.translation = Vector3(-15, 0, -10) * mm;
  } else {
    scene->objects.push_back({"table", HalfSpace{}});
  }
  if (name == "hand") {
    for (const Place& place : kHand) scene->fingers.push_back(make_finger(place.finger));
    for (std::size_t i = 1; i < scene->fingers.size(); ++i) scene->fingers[i].twin = false;
    scene->notices = {
        {2, "force_limit", "max_force_N = 0.05 keeps the device from touching: it never presses"},
        {4, "approach", "approach_mm = 10 presses 2.5 N before any touch"}};
  } else {
    scene->fingers.push_back(make_finger("index"));
    scene->fingers[0].twin = name != "corner";
    scene->fingers[0].moved_here = name == "plane";
    scene->fingers[0].fits_by_touch = name == "edge";
    scene->fingers[0].in_headset = name == "cylinder";
    if (name == "relief") {
      scene->notices = {{0, "force_limit",
                         "max_force_N = 0.05 keeps the device from touching: it never presses"}};
    }
  }
  const bool paused = snapshot_.paused;
  const DevicesStopped stopped = snapshot_.stopped;
  const std::uint32_t stops = snapshot_.stops;
  snapshot_ = {};
  snapshot_.paused = paused;
  snapshot_.stopped = stopped;
  snapshot_.stops = stops;
  snapshot_.generation = scene->generation;
  snapshot_.X_WO = {X_WO_};
  for (const SceneDescription::Finger& model : scene->fingers) {
    Snapshot::Finger& finger = snapshot_.fingers.emplace_back();
    const std::size_t samples = model.skin_rest_positions_F.size();
    finger.skin.positions_F.resize(samples);
    finger.skin.pressures.resize(samples);
    finger.skin.in_contact.resize(samples);
  }
  description_ = std::move(scene);
  fill_snapshot();
}

bool SyntheticFeed::refresh() {
  const bool asked = std::exchange(asked_, false);
  if (frozen_ && !asked) return false;
  if (!snapshot_.paused) {
    snapshot_.step += 16;
    snapshot_.time = static_cast<double>(snapshot_.step) * ms;
    snapshot_.wall_time = monotonic_time();
    if (snapshot_.time > description_->duration) start_scene(description_->scene_name);
  }
  fill_snapshot();
  return true;
}

void SyntheticFeed::fill_snapshot() {
  const double t = snapshot_.time;
  for (std::size_t i = 0; i < snapshot_.fingers.size(); ++i) fill_finger(i);
  snapshot_.step_cpu_time =
      (0.09 + 0.03 * std::abs(std::sin(7 * t)) + 0.02 * std::sin(90 * t)) * ms;
  snapshot_.match_cpu_time = 0.01 * ms;
}

void SyntheticFeed::fill_finger(std::size_t index) {
  const SceneDescription::Finger& model = description_->fingers[index];
  Snapshot::Finger& finger = snapshot_.fingers[index];
  const bool of_hand = snapshot_.fingers.size() > 1;
  const double t = snapshot_.time + 0.7 * static_cast<double>(index);
  finger.X_WFt.translation =
      Vector3(5 * std::sin(0.9 * t), 4 * std::sin(0.6 * t), 6.2 - 1.5 * std::sin(1.7 * t - 0.6)) *
      mm;
  if (std::holds_alternative<Ball>(description_->objects[0].shape)) {
    const double square = finger.X_WFt.translation.head<2>().squaredNorm();
    finger.X_WFt.translation.z() -= square / (2 * 26 * mm);
  }
  if (of_hand) {
    finger.X_WFt.translation += kHand.at(index).position;
    finger.X_WFt.rotation = exp_rotation(Vector3(0, 0, kHand.at(index).turn));
  }
  finger.X_WF = finger.X_WFt;
  finger.normal_force = 0;
  finger.contact_area = 0;
  Vector3 normal_sum = Vector3::Zero();
  double deepest = 0;
  const Pose X_OF = X_WO_.inverse() * finger.X_WF;
  for (std::size_t i = 0; i < model.skin_rest_positions_F.size(); ++i) {
    Vector3 p = model.skin_rest_positions_F[i];
    Vector3 normal;
    const double gap = distance_to(description_->objects[0].shape, X_OF * p, normal);
    finger.skin.in_contact[i] = gap < 0 ? 1 : 0;
    finger.skin.pressures[i] = static_cast<float>(std::max(0.0, -gap) * 2e7);
    if (gap < 0) {
      p -= gap * (X_OF.rotation.transpose() * normal);
      finger.normal_force += -gap * 60;
      finger.contact_area += 1.1 * mm2;
      normal_sum -= gap * normal;
      deepest = std::min(deepest, gap);
    }
    finger.skin.positions_F[i] = p.cast<float>();
  }
  finger.tangential_force = 0.1 * finger.normal_force;
  const Vector3 normal =
      normal_sum.norm() > 0 ? Vector3(normal_sum.normalized()) : Vector3::UnitZ();
  const double pitch = std::clamp(std::asin(normal.x()), -25 * deg, 25 * deg);
  const double roll = std::clamp(-std::asin(normal.y()), -25 * deg, 25 * deg);
  const double travel =
      3.2 * mm - deepest - 0.5 * mm * std::min(1.0, finger.X_WFt.translation.z() / (8 * mm));
  const Platform platform = platform_at(pitch, roll, travel);
  finger.configuration = Eigen::Vector3d(pitch, roll, travel);
  finger.joints = Eigen::Vector3d(platform.joints[0], platform.joints[1], platform.joints[2]);
  finger.X_FP = platform.X_FP;
  finger.linkage_F = platform.linkage;
  finger.pieces = {{platform.X_FP * Pose{Matrix3::Identity(), Vector3(0, 0, -1 * mm)}, 0.0}};
  finger.twin.pressed = model.twin;
  finger.twin.skin = finger.skin;
  finger.twin.normal_force = 0.9 * finger.normal_force;
  finger.twin.contact_area = finger.contact_area;
  finger.twin.measures = {};
  if (finger.normal_force > 0) {
    finger.twin.measures.iou = 1.0;
    finger.twin.measures.centroid_shift = 0.0;
    finger.twin.measures.normal_angle = 2 * deg;
    finger.twin.measures.normal_force_error = 0.1;
    finger.twin.measures.normal_force_bias = -0.1;
    finger.twin.measures.tangential_force_error = 0.3;
    finger.twin.measures.slip_ratio_error = 0.25;
  }
  finger.deviation = 0.4 * mm2;
  finger.device_state = snapshot_.stopped.asked   ? "retracting"
                        : finger.normal_force > 0 ? "rendering"
                                                  : "ready";
  for (const SceneDescription::Notice& notice : description_->notices) {
    if (notice.finger == index) finger.force_limited = notice.kind == "force_limit";
  }
}

void SyntheticFeed::request(const LiveRequest& request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
  }
  asked_ = asked_ || request.kind != LiveRequest::Kind::kPose;
  switch (request.kind) {
    case LiveRequest::Kind::kPause:
    case LiveRequest::Kind::kResume:
      snapshot_.paused = request.kind == LiveRequest::Kind::kPause;
      break;
    case LiveRequest::Kind::kRestart:
      start_scene(description_->scene_name);
      break;
    case LiveRequest::Kind::kScene:
      start_scene(request.scene);
      break;
    case LiveRequest::Kind::kObjective:
      for (std::size_t k = 0; k < description_->objectives.size(); ++k) {
        if (description_->objectives[k].name != request.objective) continue;
        snapshot_.fingers.at(request.finger).objective = static_cast<int>(k);
      }
      break;
    case LiveRequest::Kind::kRegister:
      registration_ = {.phase = RegistrationState::Phase::kRunning,
                       .finger = request.finger,
                       .held = 1,
                       .postures = 5,
                       .wanted = "left side",
                       .words = "Roll it.",
                       .progress = 0.5,
                       .message = ""};
      break;
    case LiveRequest::Kind::kCancelRegistration:
      registration_ = {};
      break;
    case LiveRequest::Kind::kFit:
      fit_ = {.phase = FitState::Phase::kPressing,
              .finger = request.finger,
              .press = 3,
              .presses = 9,
              .words = "Turned by +20 degrees of pitch and +20 of roll.",
              .force = 0.414,
              .progress = 0.22,
              .message = ""};
      if (description_->fingers.at(request.finger).fits_by_touch) {
        fit_.by_touch = true;
        fit_.presses = 10;
        fit_.words = "Press Felt, or the space bar, as soon as you feel the device.";
        fit_.force = 0.0;
      }
      break;
    case LiveRequest::Kind::kFelt:
      if (fit_.is_under_way()) ++fit_.press;
      break;
    case LiveRequest::Kind::kCancelFit:
      fit_ = {};
      break;
    case LiveRequest::Kind::kStop:
      if (fit_.is_under_way()) {
        fit_.phase = FitState::Phase::kRefused;
        fit_.message = "the device is stopped";
      }
      ++snapshot_.stops;
      snapshot_.stopped = {.asked = true, .confirmed = true};
      break;
    case LiveRequest::Kind::kRelease:
      if (request.generation == snapshot_.generation && request.stops == snapshot_.stops) {
        snapshot_.stopped = {};
      }
      break;
    case LiveRequest::Kind::kPose:
    case LiveRequest::Kind::kHold:
    case LiveRequest::Kind::kLetGo:
    case LiveRequest::Kind::kReload:
      break;  // it bobs by itself
  }
}

std::vector<LiveRequest> SyntheticFeed::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

void SyntheticFeed::offer_hand(const XrHand& hand) {
  const std::lock_guard lock(mutex_);
  hands_.push_back(hand);
}

std::optional<std::string> SyntheticFeed::take_message() {
  const std::lock_guard lock(mutex_);
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

std::string SyntheticFeed::loading() {
  const std::lock_guard lock(mutex_);
  return loading_;
}

void SyntheticFeed::set_loading(const std::string& scene) {
  const std::lock_guard lock(mutex_);
  loading_ = scene;
}

void SyntheticFeed::say(const std::string& line) {
  const std::lock_guard lock(mutex_);
  lines_.push_back(line);
}

std::vector<XrHand> SyntheticFeed::hands() const {
  const std::lock_guard lock(mutex_);
  return hands_;
}

}  // namespace softfinger
