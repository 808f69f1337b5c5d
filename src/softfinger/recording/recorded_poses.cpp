#include "softfinger/recording/recorded_poses.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {
namespace {

bool is_recording(const std::filesystem::path& file) {
  constexpr std::string_view kBegin = "SQLite format 3";
  std::array<char, kBegin.size()> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  return std::string_view(begin.data(), begin.size()) == kBegin;
}

std::int64_t find_finger(const RecordingInfo& info, const std::filesystem::path& file,
                         const std::string& name) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < info.fingers.size(); ++i) {
    if (name.empty() || info.fingers[i].name == name) return static_cast<std::int64_t>(i);
    names.push_back(info.fingers[i].name);
  }
  throw InputError(fmt::format("--finger {}: {} has no such finger; there are {}", name,
                               file.string(), fmt::join(names, ", ")));
}

}  // namespace

CsvTracker read_poses(const std::filesystem::path& file, const std::string& finger) {
  if (!is_recording(file)) {
    if (!finger.empty()) {
      throw InputError(fmt::format("--finger {}: only a recording has fingers", finger));
    }
    return CsvTracker(read_pose_csv(file));
  }
  RecordingReader reader(file);
  const std::int64_t wanted = find_finger(reader.info(), file, finger);
  std::vector<PoseSample> rows;
  StepRecord step;
  while (reader.next(step)) {
    if (step.finger != wanted || !step.tracked.valid) continue;
    rows.push_back({.time = step.time,
                    .p_WFt = step.tracked.X_WFt.translation,
                    .rotation_WFt = step.tracked.X_WFt.rotation});
  }
  if (rows.empty()) {
    throw InputError(fmt::format("{}: nothing was tracked in this recording", file.string()));
  }
  return CsvTracker(std::move(rows));
}

}  // namespace softfinger
