#include "softfinger/viewer/page_request.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace softfinger {

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
    return LiveRequest{Kind::kScene, name};
  }
  if (json.size() != 1) return {};
  if (word == "pause") return LiveRequest{Kind::kPause, {}};
  if (word == "resume") return LiveRequest{Kind::kResume, {}};
  if (word == "restart") return LiveRequest{Kind::kRestart, {}};
  return {};
}

}  // namespace softfinger
