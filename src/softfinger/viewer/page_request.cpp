#include "softfinger/viewer/page_request.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "softfinger/base/units.hpp"
#include "softfinger/person/person_registration.hpp"

namespace softfinger {
namespace {

constexpr double kFarthest = 1.0;            // m, of a coordinate
constexpr double kUnitTolerance = 0.01;      // of a quaternion's length
constexpr std::uint64_t kMostFingers = 64;   // of any scene
constexpr std::size_t kLongestName = 64;     // of any objective
constexpr std::size_t kLongestObject = 256;  // name of one that can be held

/// The `count` finite numbers of `key`; empty where it has anything else.
template <std::size_t count>
std::optional<std::array<double, count>> numbers(const nlohmann::json& json, const char* key) {
  const auto list = json.find(key);
  if (list == json.end() || !list->is_array() || list->size() != count) return {};
  std::array<double, count> values{};
  for (std::size_t k = 0; k < count; ++k) {
    if (!(*list)[k].is_number()) return {};
    values[k] = (*list)[k].get<double>();
    if (!std::isfinite(values[k])) return {};
  }
  return values;
}

std::optional<std::size_t> finger_of(const nlohmann::json& json) {
  const auto finger = json.find("finger");
  if (finger == json.end() || !finger->is_number_unsigned() ||
      finger->get<std::uint64_t>() >= kMostFingers) {
    return {};
  }
  return finger->get<std::size_t>();
}

std::optional<LiveRequest> register_request(const nlohmann::json& json) {
  LiveRequest request;
  request.kind = LiveRequest::Kind::kRegister;
  const auto finger = finger_of(json);
  if (!finger) return {};
  request.finger = *finger;
  std::size_t known = 2;  // keys
  bool sound = true;
  const auto read = [&](const char* key, double least, double most, std::optional<double>& length) {
    const auto value = json.find(key);
    if (value == json.end()) return;
    ++known;
    length = value->is_number() ? value->get<double>() * mm : most + 1.0;
    sound = sound && *length >= least && *length <= most;
  };
  read("length_mm", FingerSize::kLeast, FingerSize::kGreatest, request.measured.length);
  read("breadth_mm", FingerSize::kLeast, FingerSize::kGreatest, request.measured.breadth);
  read("depth_mm", FingerSize::kLeast, FingerSize::kGreatest, request.measured.depth);
  constexpr double kHighest = RegistrationTask::kHighestTable;
  read("table_mm", -kHighest, kHighest, request.table_height);
  if (!sound || json.size() != known) return {};
  return request;
}

std::optional<LiveRequest> fit_request(const nlohmann::json& json) {
  const auto finger = finger_of(json);
  const auto again = json.find("again");
  const bool says_again = again != json.end();
  if (!finger || json.size() != (says_again ? 3 : 2) || (says_again && !again->is_boolean())) {
    return {};
  }
  LiveRequest request;
  request.kind = LiveRequest::Kind::kFit;
  request.finger = *finger;
  request.again = says_again && again->get<bool>();
  return request;
}

/// The session knows which objectives there are, and which the device can have.
std::optional<LiveRequest> objective_request(const nlohmann::json& json) {
  const auto finger = finger_of(json);
  const auto name = json.find("objective");
  if (json.size() != 3 || !finger || name == json.end() || !name->is_string()) return {};
  LiveRequest request;
  request.kind = LiveRequest::Kind::kObjective;
  request.finger = *finger;
  request.objective = name->get<std::string>();
  if (request.objective.empty() || request.objective.size() > kLongestName) return {};
  return request;
}

std::optional<LiveRequest> release_request(const nlohmann::json& json) {
  const auto generation = json.find("generation");
  const auto stops = json.find("stops");
  if (json.size() != 3 || generation == json.end() || stops == json.end() ||
      !generation->is_number_unsigned() || !stops->is_number_unsigned()) {
    return {};
  }
  LiveRequest request;
  request.kind = LiveRequest::Kind::kRelease;
  request.generation = generation->get<std::uint64_t>();
  request.stops = stops->get<std::uint32_t>();
  return request;
}

/// Of position_mm and quaternion.
std::optional<Pose> pose_of(const nlohmann::json& json) {
  const auto position = numbers<3>(json, "position_mm");
  const auto q = numbers<4>(json, "quaternion");
  if (!position || !q) return {};
  Pose pose;
  for (std::size_t k = 0; k < 3; ++k) {
    const double coordinate = (*position)[k] * mm;
    if (std::abs(coordinate) > kFarthest) return {};
    pose.translation[static_cast<Eigen::Index>(k)] = coordinate;
  }
  const Eigen::Quaterniond rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  if (!(std::abs(rotation.norm() - 1.0) <= kUnitTolerance)) return {};
  pose.rotation = rotation.normalized().toRotationMatrix();
  return pose;
}

std::optional<LiveRequest> pose_request(const nlohmann::json& json) {
  const auto finger = finger_of(json);
  const auto pose = pose_of(json);
  if (json.size() != 4 || !finger || !pose) return {};
  LiveRequest request;
  request.kind = LiveRequest::Kind::kPose;
  request.finger = *finger;
  request.X_W = *pose;
  return request;
}

/// The session knows which objects there are, and which can be held.
std::optional<LiveRequest> object_request(const nlohmann::json& json, LiveRequest::Kind kind) {
  const auto name = json.find("object");
  if (name == json.end() || !name->is_string()) return {};
  LiveRequest request;
  request.kind = kind;
  request.object = name->get<std::string>();
  if (request.object.empty() || request.object.size() > kLongestObject) return {};
  const bool holds = kind == LiveRequest::Kind::kHold;
  if (json.size() != (holds ? 4U : 2U)) return {};
  if (!holds) return request;
  const auto pose = pose_of(json);
  if (!pose) return {};
  request.X_W = *pose;
  return request;
}

}  // namespace

std::optional<LiveRequest> parse_page_request(std::string_view message,
                                              std::span<const std::string> scene_names) {
  using Kind = LiveRequest::Kind;
  const auto json = nlohmann::json::parse(message, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return {};
  const auto request = json.find("request");
  if (request == json.end() || !request->is_string()) return {};
  const auto& word = request->get_ref<const std::string&>();
  if (word == "scene") {
    const auto scene = json.find("scene");
    if (json.size() != 2 || scene == json.end() || !scene->is_string()) return {};
    const auto& name = scene->get_ref<const std::string&>();
    if (std::ranges::find(scene_names, name) == scene_names.end()) return {};
    LiveRequest choice;
    choice.kind = Kind::kScene;
    choice.scene = name;
    return choice;
  }
  if (word == "objective") return objective_request(json);
  if (word == "pose") return pose_request(json);
  if (word == "hold") return object_request(json, Kind::kHold);
  if (word == "let_go") return object_request(json, Kind::kLetGo);
  if (word == "register") return register_request(json);
  if (word == "fit") return fit_request(json);
  if (word == "release") return release_request(json);
  if (json.size() != 1) return {};
  LiveRequest plain;
  if (word == "pause") {
    plain.kind = Kind::kPause;
  } else if (word == "resume") {
    plain.kind = Kind::kResume;
  } else if (word == "restart") {
    plain.kind = Kind::kRestart;
  } else if (word == "stop") {
    plain.kind = Kind::kStop;
  } else if (word == "cancel_registration") {
    plain.kind = Kind::kCancelRegistration;
  } else if (word == "cancel_fit") {
    plain.kind = Kind::kCancelFit;
  } else if (word == "felt") {
    plain.kind = Kind::kFelt;
  } else {
    return {};
  }
  return plain;
}

}  // namespace softfinger
