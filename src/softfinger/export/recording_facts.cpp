#include "softfinger/export/recording_facts.hpp"

#include <fmt/core.h>

#include <utility>

namespace softfinger {

std::vector<RecordingFact> recording_facts(const RecordingReader& reader) {
  const RecordingInfo& info = reader.info();
  std::vector<RecordingFact> facts{
      {"program_version", info.program_version},
      {"format_version", static_cast<double>(info.format_version)},
      {"instruction_set", info.instruction_set},
      {"scene", info.scene.string()},
      {"person", info.person.string()},
      {"simulation_rate_Hz", info.simulation_rate},
      {"live", info.live ? 1.0 : 0.0},
      {"complete", reader.complete() ? 1.0 : 0.0},
      {"dropped", static_cast<double>(reader.dropped())},
  };
  for (const RecordingInfo::Finger& finger : info.fingers) {
    const auto add = [&](const char* key, std::variant<std::string, double> value) {
      facts.push_back({info.fingers.size() > 1 ? fmt::format("{}.{}", finger.name, key) : key,
                       std::move(value)});
    };
    add("finger", finger.name);
    add("model", finger.model.string());
    add("device", finger.device.string());
    add("tracker", finger.tracker);
    add("poses", finger.poses);
    if (!finger.device.empty()) add("device_rate_Hz", finger.device_rate);
  }
  return facts;
}

}  // namespace softfinger
