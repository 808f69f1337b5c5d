#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace softfinger {

/// Bounded queue from one producer thread to one consumer thread: wait-free on both sides, no
/// allocation after construction. Slots are reused in place, so that elements that own storage keep
/// it; a claimed slot still holds some earlier element.
template <typename T>
class RingBuffer {
 public:
  /// `capacity` slots (at least 1), each a copy of `prototype`.
  explicit RingBuffer(std::size_t capacity, const T& prototype = T{})
      : slots_(capacity + 1, prototype) {}

  /// Producer: the slot to fill next; null when the buffer is full.
  [[nodiscard]] T* claim() {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (next(tail) == head_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[tail];
  }
  /// Producer: hands over the slot last claimed.
  void publish() {
    tail_.store(next(tail_.load(std::memory_order_relaxed)), std::memory_order_release);
  }

  /// Consumer: the oldest element; null when the buffer is empty.
  [[nodiscard]] T* front() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[head];
  }
  /// Consumer: gives the slot of front() back.
  void release() {
    head_.store(next(head_.load(std::memory_order_relaxed)), std::memory_order_release);
  }

  [[nodiscard]] std::size_t capacity() const { return slots_.size() - 1; }

 private:
  [[nodiscard]] std::size_t next(std::size_t index) const {
    return index + 1 == slots_.size() ? 0 : index + 1;
  }

  std::vector<T> slots_;  // one more than the capacity, to tell full from empty
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace softfinger
