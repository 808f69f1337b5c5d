#include "softfinger/base/tracker_kind.hpp"

#include <fmt/format.h>

#include "softfinger/base/config_file.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {

TrackerSpec parse_tracker_spec(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view argument =
      colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  if (kind == "script" || kind == "page") {
    if (colon != std::string_view::npos) {
      throw InputError(fmt::format("tracker {} takes nothing after it, found '{}'", kind, text));
    }
    return {.kind = kind == "page" ? TrackerKind::kPage : TrackerKind::kScript, .file = {}};
  }
  if (kind == "csv") {
    if (argument.empty()) throw InputError("tracker csv needs a file, as in csv:poses.csv");
    return {.kind = TrackerKind::kCsv, .file = std::string(argument)};
  }
  const std::string nearest = nearest_word(kind, {"script", "csv", "page"});
  throw InputError(fmt::format("unknown tracker '{}'; {}known are script, csv:FILE and page", text,
                               nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest)));
}

}  // namespace softfinger
