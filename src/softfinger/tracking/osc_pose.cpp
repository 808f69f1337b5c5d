#include "softfinger/tracking/osc_pose.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace softfinger {
namespace {

constexpr int kDeepestBundle = 4;
constexpr std::size_t kWord = 4;  // everything in OSC is a multiple of this, bytes
constexpr std::size_t kPoseNumbers = 7;
constexpr std::string_view kBundle{"#bundle\0", 8};

using Bytes = std::span<const std::uint8_t>;

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Takes the first `count` bytes off `rest`; false where there are fewer.
bool take(Bytes& rest, std::size_t count, Bytes& taken) {
  if (count > rest.size()) return false;
  taken = rest.first(count);
  rest = rest.subspan(count);
  return true;
}

/// An OSC-string: characters and one to four NULs, to a whole number of words.
bool take_string(Bytes& rest, std::string_view& text) {
  std::size_t length = 0;
  while (length < rest.size() && rest[length] != 0) ++length;
  Bytes all;
  if (!take(rest, (length / kWord + 1) * kWord, all)) return false;
  for (const std::uint8_t padding : all.subspan(length)) {
    if (padding != 0) return false;
  }
  text = {reinterpret_cast<const char*>(all.data()), length};
  return true;
}

/// Passes over one argument; false where the tag is unknown or the bytes end.
bool skip_argument(char tag, Bytes& rest) {
  Bytes taken;
  std::string_view text;
  switch (tag) {
    case 'T':
    case 'F':
    case 'N':
    case 'I':
      return true;
    case 'i':
    case 'f':
    case 'c':
    case 'r':
    case 'm':
      return take(rest, 4, taken);
    case 'h':
    case 'd':
    case 't':
      return take(rest, 8, taken);
    case 's':
    case 'S':
      return take_string(rest, text);
    case 'b': {
      if (!take(rest, 4, taken)) return false;
      const std::size_t size = big_endian(taken);
      return size <= rest.size() && take(rest, (size + kWord - 1) / kWord * kWord, taken);
    }
    default:
      return false;
  }
}

bool read_pose(std::string_view tags, Bytes arguments, std::optional<PoseMessage>& found) {
  if (tags != "fffffff" && tags != "ddddddd") return false;
  const std::size_t size = tags[0] == 'f' ? 4 : 8;
  if (arguments.size() != kPoseNumbers * size) return false;
  std::array<double, kPoseNumbers> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::uint64_t bits = big_endian(arguments.subspan(i * size, size));
    v[i] = size == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                     : std::bit_cast<double>(bits);
  }
  const auto pose = pose_from_outside({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  if (!pose) return false;
  found = PoseMessage{.X_WFt = *pose, .valid = true, .sequence = {}, .time = {}};
  return true;
}

bool read_message(Bytes rest, std::optional<PoseMessage>& found) {
  std::string_view address;
  std::string_view tags;
  if (!take_string(rest, address) || !address.starts_with('/')) return false;
  if (!take_string(rest, tags) || !tags.starts_with(',')) return false;
  tags.remove_prefix(1);
  if (address == kOscPoseAddress) return read_pose(tags, rest, found);
  for (const char tag : tags) {
    if (!skip_argument(tag, rest)) return false;
  }
  return rest.empty();
}

/// False where the packet breaks the format.
bool read_packet(Bytes rest, int depth, std::optional<PoseMessage>& found) {
  if (rest.empty() || rest.size() % kWord != 0) return false;
  if (rest.size() < kBundle.size() || std::memcmp(rest.data(), kBundle.data(), kBundle.size()) != 0)
    return read_message(rest, found);
  Bytes taken;
  if (depth == kDeepestBundle || !take(rest, kBundle.size() + 8, taken)) return false;
  while (!rest.empty()) {
    if (!take(rest, kWord, taken)) return false;
    const std::size_t size = big_endian(taken);
    if (!take(rest, size, taken) || !read_packet(taken, depth + 1, found)) return false;
  }
  return true;
}

void append(std::vector<std::uint8_t>& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  do bytes.push_back(0);
  while (bytes.size() % kWord != 0);
}

}  // namespace

std::optional<PoseMessage> decode_osc_pose(std::span<const std::uint8_t> packet) {
  std::optional<PoseMessage> found;
  if (!read_packet(packet, 0, found)) return std::nullopt;
  return found;
}

std::vector<std::uint8_t> encode_osc_pose(const Pose& X_WFt, bool float64) {
  std::vector<std::uint8_t> bytes;
  append(bytes, kOscPoseAddress);
  append(bytes, float64 ? ",ddddddd" : ",fffffff");
  const Eigen::Quaterniond q(X_WFt.rotation);
  const Vector3& p = X_WFt.translation;
  for (const double number : {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}) {
    const std::uint64_t bits = float64 ? std::bit_cast<std::uint64_t>(number)
                                       : std::bit_cast<std::uint32_t>(static_cast<float>(number));
    for (int shift = float64 ? 56 : 24; shift >= 0; shift -= 8) {
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  return bytes;
}

}  // namespace softfinger
