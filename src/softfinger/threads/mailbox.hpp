#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace softfinger {

/// Passes only the newest value from one writer thread to one reader thread: a triple buffer,
/// wait-free on both sides, no allocation after construction. The reader may skip values, never
/// sees a torn or an older one. No bytes in it, whoever shares and spoils them, lead out of it.
template <typename T>
class Mailbox {
 public:
  Mailbox() = default;
  explicit Mailbox(const T& initial) : slots_{initial, initial, initial} {}

  /// Writer: the slot to fill next. Its old content is some earlier value.
  T& draft() { return slots_[writing_ % slots_.size()]; }
  /// Writer: makes draft() the newest value.
  void publish() {
    writing_ =
        middle_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) &
        kIndex;
  }
  /// Reader: takes over the newest value if there is one not yet taken; says whether there was.
  bool refresh() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  /// Reader: the value last taken.
  [[nodiscard]] const T& latest() const { return slots_[reading_ % slots_.size()]; }

 private:
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::uint8_t kIndex = 3;
  std::array<T, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t writing_ = 0;
  alignas(64) std::uint8_t reading_ = 2;
};

}  // namespace softfinger
