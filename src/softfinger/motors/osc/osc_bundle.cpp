#include "softfinger/motors/osc/osc_bundle.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace softfinger {
namespace {

constexpr std::string_view kBundleStart{"#bundle\0\0\0\0\0\0\0\0\x01", 16};  // with its time tag
constexpr std::size_t kTimeTagAt = 8;
constexpr std::string_view kTags{",f\0\0", 4};
constexpr std::size_t kFloatSize = 4;

/// With at least one NUL, to a multiple of four.
std::size_t padded(std::size_t letters) { return (letters / 4 + 1) * 4; }

std::size_t message_size(const OscFloat& message) {
  return padded(message.address.size()) + kTags.size() + kFloatSize;
}

void put_big_endian(std::uint32_t value, std::span<std::uint8_t> out) {
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = static_cast<std::uint8_t>((value >> (24 - 8 * i)) & 0xFF);
  }
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[i];
  return value;
}

void put_text(std::string_view text, std::span<std::uint8_t> out) {
  std::memcpy(out.data(), text.data(), text.size());
}

std::optional<OscFloat> decode_message(std::span<const std::uint8_t> bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), 0);
  const auto letters = static_cast<std::size_t>(end - bytes.begin());
  const std::size_t tags = padded(letters);
  if (letters == 0 || bytes[0] != '/' || bytes.size() != tags + kTags.size() + kFloatSize) {
    return std::nullopt;
  }
  const bool zeros = std::all_of(bytes.begin() + static_cast<std::ptrdiff_t>(letters),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(tags),
                                 [](std::uint8_t byte) { return byte == 0; });
  if (!zeros || std::memcmp(bytes.data() + tags, kTags.data(), kTags.size()) != 0) {
    return std::nullopt;
  }
  return OscFloat{{reinterpret_cast<const char*>(bytes.data()), letters},
                  std::bit_cast<float>(big_endian(bytes.subspan(tags + kTags.size())))};
}

}  // namespace

std::size_t osc_bundle_size(std::span<const OscFloat> messages) {
  std::size_t size = kBundleStart.size();
  for (const OscFloat& message : messages) size += 4 + message_size(message);
  return size;
}

std::size_t encode_osc_bundle(std::span<const OscFloat> messages, std::span<std::uint8_t> out) {
  const std::size_t size = osc_bundle_size(messages);
  assert(out.size() >= size);
  std::fill_n(out.begin(), size, std::uint8_t{0});
  put_text(kBundleStart, out);
  std::size_t at = kBundleStart.size();
  for (const OscFloat& message : messages) {
    put_big_endian(static_cast<std::uint32_t>(message_size(message)), out.subspan(at));
    put_text(message.address, out.subspan(at + 4));
    at += 4 + padded(message.address.size());
    put_text(kTags, out.subspan(at));
    put_big_endian(std::bit_cast<std::uint32_t>(message.value), out.subspan(at + kTags.size()));
    at += kTags.size() + kFloatSize;
  }
  return size;
}

std::optional<std::vector<OscFloat>> decode_osc_bundle(std::span<const std::uint8_t> packet) {
  if (packet.size() < kBundleStart.size() || packet.size() % 4 != 0 ||
      std::memcmp(packet.data(), kBundleStart.data(), kTimeTagAt) != 0) {
    return std::nullopt;
  }
  std::vector<OscFloat> messages;
  for (auto rest = packet.subspan(kBundleStart.size()); !rest.empty();) {
    const std::size_t size = big_endian(rest);
    rest = rest.subspan(4);
    if (size > rest.size()) return std::nullopt;
    const auto message = decode_message(rest.first(size));
    if (!message) return std::nullopt;
    messages.push_back(*message);
    rest = rest.subspan(size);
  }
  return messages;
}

}  // namespace softfinger
