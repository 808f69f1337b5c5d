#include "softfinger/viewer/notification_message.hpp"

#include <nlohmann/json.hpp>

namespace softfinger {

std::string notification_message(std::span<const std::string> lines) {
  const nlohmann::ordered_json message{
      {"type", "notifications"}, {"lines", std::vector<std::string>(lines.begin(), lines.end())}};
  // Lines name files, which may hold broken UTF-8.
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string loading_message(std::string_view scene) {
  const nlohmann::ordered_json message{{"type", "loading"}, {"scene", scene}};
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace softfinger
