#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "softfinger/loop/device_loop.hpp"
#include "softfinger/threads/mailbox.hpp"

namespace softfinger {

/// What a step hands to the thread of its device.
struct HandedTick {
  TickInput input;
  ContactSet contact;
  std::vector<Vector3> nodes_W;
  Pose X_WF;

  [[nodiscard]] VirtualFinger finger() const { return {contact, nodes_W, X_WF}; }
};

/// The way of virtual fingers from the thread of the steps to the thread of the device: the newest
/// alone, whatever the device is busy with.
class TickHandover {
 public:
  /// Of a finger of this model.
  explicit TickHandover(const FingerModel& model);

  /// Thread of the steps; wait-free, allocates nothing.
  void hand_over(const TickInput& input, const VirtualFinger& finger);
  /// What was handed over last; step 0: nothing yet.
  [[nodiscard]] const TickInput& last() const { return last_; }
  /// Thread of the device: waits for the newest that was not taken yet; null: there comes no more.
  const HandedTick* take();
  /// Any thread: take() returns null from here on, whatever lies there.
  void end();

 private:
  void ring();

  TickInput last_;
  Mailbox<HandedTick> mailbox_;
  std::atomic<std::uint32_t> doorbell_{0};
  std::uint32_t heard_ = 0;  ///< thread of the device
  std::atomic<bool> ended_{false};
};

}  // namespace softfinger
