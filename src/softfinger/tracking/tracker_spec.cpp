#include "softfinger/tracking/tracker_spec.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kLongestName = 255;  // of hosts and bodies

bool parse_port(std::string_view text, std::uint16_t& port) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  return error == std::errc() && stop == end && port > 0;
}

bool is_ipv4_address(std::string_view text) {
  for (int part = 0; part < 4; ++part) {
    std::uint8_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc()) return false;
    if (part == 3) return stop == end;
    if (stop == end || *stop != '.') return false;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()) + 1);
  }
  return false;
}

/// "[ADDRESS:]PORT" of a tracker that listens.
void read_listener(std::string_view text, std::string_view argument, TrackerSpec& spec) {
  const std::size_t colon = argument.rfind(':');
  if (colon != std::string_view::npos) spec.address = argument.substr(0, colon);
  const std::string_view port =
      colon == std::string_view::npos ? argument : argument.substr(colon + 1);
  if (!is_ipv4_address(spec.address) || !parse_port(port, spec.port)) {
    const std::string_view kind = row_of(kTrackers, spec.kind).name;
    throw InputError(
        fmt::format("tracker '{}': expected {}:PORT or {}:ADDRESS:PORT with a port of 1 to 65535 "
                    "and an IPv4 address of this machine",
                    text, kind, kind));
  }
}

HandPart read_hand(std::string_view text, std::string_view argument) {
  const auto hand = parse_hand_part(argument);
  if (hand) return *hand;
  throw InputError(
      fmt::format("tracker '{}': expected webxr, or webxr: with right or left, a finger out of "
                  "thumb, index, middle, ring and pinky, or both as in webxr:left-thumb",
                  text));
}

void read_natnet_option(std::string_view text, std::string_view option, TrackerSpec& spec) {
  const std::size_t equals = option.find('=');
  const std::string_view key = option.substr(0, equals);
  const std::string_view value =
      equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
  const auto refuse = [&](std::string_view what) {
    throw InputError(fmt::format("tracker '{}': {}", text, what));
  };
  if (key == "body") {
    if (value.empty() || value.size() > kLongestName) refuse("body= needs a rigid body's name");
    spec.body = value;
  } else if (key == "up") {
    if (value != "y" && value != "z") refuse("up= must be y or z, as in the streaming settings");
    spec.up = value == "z" ? UpAxis::kZ : UpAxis::kY;
  } else if (key == "scale") {
    const char* const end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, spec.scale);
    if (error != std::errc() || stop != end || !(spec.scale >= 1e-6 && spec.scale <= 1e6)) {
      refuse("scale= must be a number of 1e-6 to 1e6, metres per unit streamed");
    }
  } else if (option == "multicast" || option == "unicast") {
    spec.multicast = option == "multicast";
  } else {
    const std::string nearest = nearest_word(key, {"body", "up", "scale", "multicast", "unicast"});
    refuse(
        fmt::format("unknown option '{}'; {}known are body=NAME, up=y|z, scale=S, multicast and "
                    "unicast",
                    option, nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest)));
  }
}

/// "HOST[:PORT],body=NAME[,up=y|z][,scale=S][,multicast|unicast]".
void read_natnet(std::string_view text, std::string_view argument, TrackerSpec& spec) {
  std::size_t comma = argument.find(',');
  std::string_view host = argument.substr(0, comma);
  spec.port = kNatNetCommandPort;
  const std::size_t colon = host.find(':');
  const bool port_is_good =
      colon == std::string_view::npos || parse_port(host.substr(colon + 1), spec.port);
  host = host.substr(0, colon);
  if (!port_is_good || host.empty() || host.size() > kLongestName) {
    throw InputError(fmt::format(
        "tracker '{}': expected natnet:HOST[:PORT],body=NAME with a port of 1 to 65535", text));
  }
  spec.address = host;
  while (comma != std::string_view::npos) {
    argument.remove_prefix(comma + 1);
    comma = argument.find(',');
    read_natnet_option(text, argument.substr(0, comma), spec);
  }
  if (spec.body.empty()) {
    throw InputError(fmt::format(
        "tracker '{}': which rigid body? add ,body=NAME with its name in the tracker's program",
        text));
  }
}

}  // namespace

std::string trackers_in_brief(std::string_view last, bool (*wanted)(const TrackerRow&)) {
  std::vector<std::string> briefs;
  for (const TrackerRow& row : kTrackers) {
    if (wanted(row)) briefs.emplace_back(row.brief);
  }
  return listed(briefs, last);
}

TrackerSpec parse_tracker_spec(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const std::string_view argument =
      colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  const TrackerRow* const row = row_named(kTrackers, name);
  if (row == nullptr) {
    const std::string nearest = nearest_word(name, names_of(kTrackers));
    throw InputError(fmt::format("unknown tracker '{}'; {}known are {}", text,
                                 nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest),
                                 trackers_in_brief("and", [](const TrackerRow&) { return true; })));
  }
  TrackerSpec spec;
  spec.kind = row->value;
  switch (spec.kind) {
    case TrackerKind::kScript:
    case TrackerKind::kPage:
      if (colon != std::string_view::npos) {
        throw InputError(fmt::format("tracker {} takes nothing after it, found '{}'", name, text));
      }
      break;
    case TrackerKind::kCsv:
      if (argument.empty()) throw InputError("tracker csv needs a file, as in csv:poses.csv");
      spec.file = argument;
      break;
    case TrackerKind::kWebXr:
      if (colon != std::string_view::npos) spec.hand = read_hand(text, argument);
      break;
    case TrackerKind::kUdp:
    case TrackerKind::kOsc:
      read_listener(text, argument, spec);
      break;
    case TrackerKind::kNatnet:
      read_natnet(text, argument, spec);
      break;
  }
  return spec;
}

bool tracks_whole_hand(std::string_view text) {
  const TrackerSpec spec = parse_tracker_spec(text);
  return spec.kind == TrackerKind::kWebXr && !spec.hand.finger;
}

std::string tracker_of_finger(std::string_view text, std::string_view finger_name) {
  if (!tracks_whole_hand(text)) return std::string(text);
  const HandFinger finger = hand_finger_of(finger_name).value_or(HandFinger::kIndex);
  return fmt::format("webxr:{}-{}", name_of(parse_tracker_spec(text).hand.side), name_of(finger));
}

bool is_network_tracker(TrackerKind kind) {
  return row_of(kTrackers, kind).origin == PoseOrigin::kNetwork;
}

}  // namespace softfinger
