#pragma once

#include <string>
#include <variant>
#include <vector>

#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {

/// Something that a recording says of its run as a whole.
struct RecordingFact {
  std::string key;  ///< with the unit of a number
  std::variant<std::string, double> value;
};

/// Who made it and of what: program, scene, rates, and finger, model, device, tracker of each
/// finger, "NAME.device" where there are several. docs/files.md has the keys.
[[nodiscard]] std::vector<RecordingFact> recording_facts(const RecordingReader& reader);

}  // namespace softfinger
