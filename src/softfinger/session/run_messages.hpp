#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/run_finger.hpp"

namespace softfinger {

/// What a person should know while a run goes on: of their devices, once; a tracker or a device
/// lost or back; rows not recorded, or late.
class RunMessages {
 public:
  /// One line, each told once; empty: nothing more now. One thread. `recording`: null for none.
  [[nodiscard]] std::optional<std::string> take(
      const RunSetup& setup, const std::vector<std::unique_ptr<RunFinger>>& fingers,
      const RecordingWriter* recording);

 private:
  [[nodiscard]] std::optional<std::string> take_notice(const RunSetup& setup);
  [[nodiscard]] std::optional<std::string> take_of(const RecordingWriter& recording);

  struct {
    std::size_t finger = 0, notice = 0;
  } next_notice_;
  bool told_dropped_ = false;
  bool told_waited_ = false;
  bool told_failed_ = false;
};

}  // namespace softfinger
