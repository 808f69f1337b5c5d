#include "softfinger/viewer/fit_message.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace softfinger {

std::string fit_message(const FitState& state) {
  static constexpr std::array<std::string_view, 6> kPhases{"idle",       "waiting", "pressing",
                                                           "estimating", "saved",   "refused"};
  const nlohmann::ordered_json message{
      {"type", "fit"},
      {"state", kPhases.at(static_cast<std::size_t>(state.phase))},
      {"finger", state.finger},
      {"by_touch", state.by_touch},
      {"press", state.press},
      {"of", state.presses},
      {"words", state.words},
      // Coarse, so that a message goes out only where something can be seen.
      {"force_N", std::round(state.force * 100.0) / 100.0},
      {"progress", std::round(state.progress * 20.0) / 20.0},
      {"message", state.message}};
  // Messages name files, which may hold broken UTF-8.
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace softfinger
