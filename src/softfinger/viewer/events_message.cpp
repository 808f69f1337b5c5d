#include "softfinger/viewer/events_message.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace softfinger {

std::string events_message(std::uint64_t generation, std::span<const LiveEvent> events) {
  using Json = nlohmann::ordered_json;
  Json message{{"type", "events"}, {"generation", generation}, {"events", Json::array()}};
  for (const LiveEvent& event : events) {
    message["events"].push_back(
        {{"time_s", event.time},
         {"kind", event.kind},
         {"object", event.object},
         {"other", event.other.empty() ? Json() : Json(event.other)},
         {"impulse_N_s", std::isnan(event.impulse) ? Json() : Json(event.impulse)}});
  }
  // Names come from files and may hold broken UTF-8.
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace softfinger
