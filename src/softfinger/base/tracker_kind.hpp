#pragma once

#include <string>
#include <string_view>

namespace softfinger {

/// Where tracked poses may come from.
enum class TrackerKind { kScript, kCsv, kPage };

/// A tracker as a scene file or `--tracker` names it: "script", "csv:FILE", "page".
struct TrackerSpec {
  TrackerKind kind = TrackerKind::kScript;
  std::string file;  ///< kCsv: as written
};

/// Throws InputError, without a place, that lists the known kinds.
[[nodiscard]] TrackerSpec parse_tracker_spec(std::string_view text);

}  // namespace softfinger
