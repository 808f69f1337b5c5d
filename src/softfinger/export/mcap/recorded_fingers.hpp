#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {

/// A finger of a recording, built again from the files that it carries.
struct RecordedFinger {
  std::shared_ptr<const FingerModel> model;  ///< null: cannot be built
  std::shared_ptr<const Device> device;      ///< null: none, or cannot be built
};

struct RecordedFingers {
  std::vector<RecordedFinger> fingers;  ///< one for each of the recording
  std::string lack;                     ///< one line: why some could not be built; empty: all were
};

[[nodiscard]] RecordedFingers recorded_fingers(const RecordingReader& reader);

}  // namespace softfinger
