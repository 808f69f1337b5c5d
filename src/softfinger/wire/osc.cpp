#include "softfinger/wire/osc.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace softfinger {
namespace {

constexpr int kDeepestBundle = 4;
constexpr std::size_t kWord = 4;  // everything in OSC is a multiple of this, bytes
constexpr std::string_view kBundle{"#bundle\0", 8};
constexpr std::size_t kTimeTag = 8;  // bytes

using Bytes = std::span<const std::uint8_t>;

/// Of a string with at least one NUL, to a whole number of words.
std::size_t padded(std::size_t letters) { return (letters / kWord + 1) * kWord; }

std::size_t size_of(OscNumber type) { return type == OscNumber::kFloat32 ? 4 : 8; }

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Takes the first `count` bytes off `rest`; false where there are fewer.
bool take_bytes(Bytes& rest, std::size_t count, Bytes& taken) {
  if (count > rest.size()) return false;
  taken = rest.first(count);
  rest = rest.subspan(count);
  return true;
}

/// An OSC-string: characters and one to four NULs, to a whole number of words.
bool take_string(Bytes& rest, std::string_view& text) {
  const auto length =
      static_cast<std::size_t>(std::find(rest.begin(), rest.end(), 0) - rest.begin());
  Bytes all;
  if (!take_bytes(rest, padded(length), all)) return false;
  const Bytes padding = all.subspan(length);
  if (std::any_of(padding.begin(), padding.end(), [](std::uint8_t byte) { return byte != 0; })) {
    return false;
  }
  text = {reinterpret_cast<const char*>(all.data()), length};
  return true;
}

/// Passes over one argument; false where its type is unknown or the bytes end.
bool skip_argument(char type, Bytes& rest) {
  Bytes taken;
  std::string_view text;
  switch (type) {
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
      return take_bytes(rest, 4, taken);
    case 'h':
    case 'd':
    case 't':
      return take_bytes(rest, 8, taken);
    case 's':
    case 'S':
      return take_string(rest, text);
    case 'b': {
      if (!take_bytes(rest, 4, taken)) return false;
      const std::size_t size = big_endian(taken);
      return size <= rest.size() && take_bytes(rest, (size + kWord - 1) / kWord * kWord, taken);
    }
    default:
      return false;
  }
}

bool read_message(Bytes rest, const std::function<bool(const OscMessage&)>& take) {
  OscMessage message;
  if (!take_string(rest, message.address) || !message.address.starts_with('/')) return false;
  if (!take_string(rest, message.types) || !message.types.starts_with(',')) return false;
  message.types.remove_prefix(1);
  message.arguments = rest;
  for (const char type : message.types) {
    if (!skip_argument(type, rest)) return false;
  }
  return rest.empty() && take(message);
}

bool read_packet(Bytes rest, int depth, const std::function<bool(const OscMessage&)>& take) {
  if (rest.empty() || rest.size() % kWord != 0) return false;
  if (!is_osc_bundle(rest)) return read_message(rest, take);
  Bytes taken;
  if (depth == kDeepestBundle || !take_bytes(rest, kBundle.size() + kTimeTag, taken)) return false;
  while (!rest.empty()) {
    if (!take_bytes(rest, kWord, taken)) return false;
    const std::size_t size = big_endian(taken);
    if (!take_bytes(rest, size, taken) || !read_packet(taken, depth + 1, take)) return false;
  }
  return true;
}

}  // namespace

bool OscMessage::read(std::span<double> numbers) const {
  if (types.size() != numbers.size() || types.empty()) return false;
  const char type = types.front();
  if ((type != 'f' && type != 'd') || types.find_first_not_of(type) != std::string_view::npos) {
    return false;
  }
  const std::size_t size = size_of(type == 'f' ? OscNumber::kFloat32 : OscNumber::kFloat64);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint64_t bits = big_endian(arguments.subspan(i * size, size));
    numbers[i] = type == 'f' ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                             : std::bit_cast<double>(bits);
  }
  return true;
}

bool read_osc(Bytes packet, const std::function<bool(const OscMessage&)>& take) {
  return read_packet(packet, 0, take);
}

bool is_osc_bundle(Bytes packet) {
  return packet.size() >= kBundle.size() &&
         std::memcmp(packet.data(), kBundle.data(), kBundle.size()) == 0;
}

std::size_t osc_message_size(std::string_view address, std::size_t numbers, OscNumber type) {
  return osc_message_size(address, {}, numbers, type);
}

std::size_t osc_message_size(std::string_view address, std::span<const std::string_view> texts,
                             std::size_t numbers, OscNumber type) {
  std::size_t size = padded(address.size()) + padded(1 + texts.size() + numbers);
  for (const std::string_view text : texts) size += padded(text.size());
  return size + numbers * size_of(type);
}

void OscWriter::bundle() {
  assert(size_ == 0);
  put_text(kBundle.substr(0, kBundle.size() - 1));
  put_word(0);
  put_word(1);  // the time tag "immediately"
  in_bundle_ = true;
}

void OscWriter::message(std::string_view address, std::span<const double> numbers, OscNumber type) {
  message(address, {}, numbers, type);
}

void OscWriter::message(std::string_view address, std::span<const std::string_view> texts,
                        std::span<const double> numbers, OscNumber type) {
  if (in_bundle_) {
    put_word(static_cast<std::uint32_t>(osc_message_size(address, texts, numbers.size(), type)));
  }
  put_text(address);
  const std::size_t letters = 1 + texts.size() + numbers.size();
  assert(size_ + padded(letters) <= out_.size());
  const auto types = out_.subspan(size_, padded(letters));
  std::fill(types.begin(), types.end(), std::uint8_t{0});
  types[0] = ',';
  const auto end_of_texts = std::fill_n(types.begin() + 1, texts.size(), 's');
  std::fill_n(end_of_texts, numbers.size(), type == OscNumber::kFloat32 ? 'f' : 'd');
  size_ += types.size();
  for (const std::string_view text : texts) put_text(text);
  for (const double number : numbers) {
    if (type == OscNumber::kFloat32) {
      put_word(std::bit_cast<std::uint32_t>(static_cast<float>(number)));
    } else {
      const auto bits = std::bit_cast<std::uint64_t>(number);
      put_word(static_cast<std::uint32_t>(bits >> 32));
      put_word(static_cast<std::uint32_t>(bits));
    }
  }
}

void OscWriter::put_word(std::uint32_t value) {
  assert(size_ + kWord <= out_.size());
  for (int shift = 24; shift >= 0; shift -= 8) {
    out_[size_++] = static_cast<std::uint8_t>(value >> shift);
  }
}

void OscWriter::put_text(std::string_view text) {
  assert(size_ + padded(text.size()) <= out_.size());
  const auto end =
      std::copy(text.begin(), text.end(), out_.begin() + static_cast<std::ptrdiff_t>(size_));
  std::fill_n(end, padded(text.size()) - text.size(), std::uint8_t{0});
  size_ += padded(text.size());
}

}  // namespace softfinger
