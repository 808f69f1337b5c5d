#include "softfinger/viewer/notification_message.hpp"

#include <nlohmann/json.hpp>

namespace softfinger {

std::string notification_message(std::span<const std::string> lines) {
  const nlohmann::ordered_json message{
      {"type", "notifications"}, {"lines", std::vector<std::string>(lines.begin(), lines.end())}};
  // Lines name files, which may hold broken UTF-8.
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace softfinger
