#include "softfinger/viewer/registration_message.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace softfinger {

std::string registration_message(const RegistrationState& state) {
  static constexpr std::array<std::string_view, 4> kPhases{"idle", "running", "saved", "refused"};
  const nlohmann::ordered_json message{
      {"type", "registration"},
      {"state", kPhases.at(static_cast<std::size_t>(state.phase))},
      {"finger", state.finger},
      {"held", state.held},
      {"of", state.postures},
      {"posture", state.wanted},
      {"words", state.words},
      // Coarse, so that a message goes out only where something can be seen.
      {"progress", std::round(state.progress * 20.0) / 20.0},
      {"message", state.message}};
  // Messages name files, which may hold broken UTF-8.
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace softfinger
