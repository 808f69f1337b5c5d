#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace softfinger {

// Packets of "The Open Sound Control 1.0 Specification" (2002).

/// A message of a packet, into which it points.
struct OscMessage {
  std::string_view address;                 ///< "/..."
  std::string_view types;                   ///< a letter an argument, without the comma
  std::span<const std::uint8_t> arguments;  ///< as many bytes as `types` says

  /// The arguments, where they are exactly `numbers.size()` numbers, all float32 (`f`) or all
  /// float64 (`d`); false where they are anything else.
  [[nodiscard]] bool read(std::span<double> numbers) const;
};

/// Hands every message of a packet, a message or a bundle of packets nested at most four deep, to
/// `take`, in their order. False where the packet breaks the format or `take` says false, at once:
/// earlier messages have been handed on then. Time tags are not looked at.
[[nodiscard]] bool read_osc(std::span<const std::uint8_t> packet,
                            const std::function<bool(const OscMessage&)>& take);
/// Whether a packet begins as a bundle does.
[[nodiscard]] bool is_osc_bundle(std::span<const std::uint8_t> packet);

enum class OscNumber { kFloat32, kFloat64 };

/// Bytes of a message with so many numbers.
[[nodiscard]] std::size_t osc_message_size(std::string_view address, std::size_t numbers,
                                           OscNumber type);
/// The same with texts before them.
[[nodiscard]] std::size_t osc_message_size(std::string_view address,
                                           std::span<const std::string_view> texts,
                                           std::size_t numbers, OscNumber type);
/// Bytes of a bundle of nothing, and what each message in a bundle needs beside its own.
inline constexpr std::size_t kOscBundleStart = 16;
inline constexpr std::size_t kOscElementStart = 4;

/// Writes one packet to the front of `out`, which must have room. Allocates nothing.
class OscWriter {
 public:
  explicit OscWriter(std::span<std::uint8_t> out) : out_(out) {}

  /// Before the first message: it and all others are elements of a bundle, to be taken at once.
  void bundle();
  void message(std::string_view address, std::span<const double> numbers, OscNumber type);
  /// Texts, which have no zero in them, then numbers.
  void message(std::string_view address, std::span<const std::string_view> texts,
               std::span<const double> numbers, OscNumber type);
  /// Bytes written.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void put_word(std::uint32_t value);
  void put_text(std::string_view text);

  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  bool in_bundle_ = false;
};

}  // namespace softfinger
