#include "softfinger/session/run_messages.hpp"

#include <fmt/core.h>

namespace softfinger {

std::optional<std::string> RunMessages::take(const RunSetup& setup,
                                             const std::vector<std::unique_ptr<RunFinger>>& fingers,
                                             const RecordingWriter* recording) {
  if (auto notice = take_notice(setup)) return notice;
  for (const auto& finger : fingers) {
    if (auto message = finger->tracker.take_message()) return message;
    if (!finger->chain || !finger->chain->has_device()) continue;
    Actuator& actuator = finger->chain->device().actuator();
    if (const auto event = actuator.take_event()) return actuator.message(*event);
  }
  return recording != nullptr ? take_of(*recording) : std::nullopt;
}

std::optional<std::string> RunMessages::take_notice(const RunSetup& setup) {
  for (; next_notice_.finger < setup.notices.size(); next_notice_ = {next_notice_.finger + 1, 0}) {
    const auto& notices = setup.notices[next_notice_.finger];
    if (next_notice_.notice == notices.size()) continue;
    const DeviceNotice& notice = notices[next_notice_.notice++];
    return fmt::format("{}: {}: {}", setup.scene.fingers[next_notice_.finger].name, notice.key,
                       notice.text);
  }
  return std::nullopt;
}

std::optional<std::string> RunMessages::take_of(const RecordingWriter& recording) {
  if (!told_failed_ && recording.failed()) {
    told_failed_ = true;
    return fmt::format("{}: can no longer be written; the run goes on unrecorded",
                       recording.file().string());
  }
  if (!told_dropped_ && recording.dropped() > 0) {
    told_dropped_ = true;
    return fmt::format("{}: the disk is too slow, rows are missing from the recording",
                       recording.file().string());
  }
  if (!told_waited_ && recording.waited_for_disk()) {
    told_waited_ = true;
    return fmt::format(
        "{0}: the disk is too slow, {1}-wal is at its longest and rows wait for the disk; a run "
        "that is killed meanwhile loses them",
        recording.file().string(), recording.file().filename().string());
  }
  return std::nullopt;
}

}  // namespace softfinger
