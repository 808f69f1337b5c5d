#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>

#include "softfinger/loop/device_clock.hpp"
#include "softfinger/loop/device_loop.hpp"
#include "softfinger/loop/finger_loop.hpp"

namespace softfinger {

/// What a chain is made of.
struct FingerChainOptions {
  std::int64_t finger = 0;                    ///< its number in records
  std::shared_ptr<const FingerModel> model;   ///< simulated
  std::span<const VirtualObject> objects;     ///< must outlive the chain
  double simulation_rate = 1000.0;            ///< Hz
  bool with_state = false;                    ///< step records carry nodes and samples
  ThreadTeam* team = nullptr;                 ///< see FingerSimulation
  int hand = -1;                              ///< likewise
  std::shared_ptr<const Device> device = {};  ///< null: none
  DeviceLoopOptions device_loop = {};
};

/// One finger from its tracked pose to its motors: finger loop, device clock, and device loop with
/// its actuator. Every run, every replay and the library go through these calls in this order, and
/// record what they return in the order they return it:
///
///     record(chain.start(tracked));
///     for (std::int64_t step = 1;; ++step) {
///       chain.step(step, tracked);
///       if (chain.tick_is_due()) record(chain.tick(chain.tick_input(taken)));
///       record(chain.seal());
///     }
///
/// In a live run ticks are taken on another thread, of the virtual finger that was handed over to
/// it (TickHandover); steps go on, and know() says which tick they know of. The two sides share
/// nothing: start(), step(), tick_is_due(), tick_input(), know(), seal() and loop() belong to one
/// thread, tick() of a virtual finger and device() to one other. None of these allocates, locks or
/// throws.
class FingerChain {
 public:
  /// Throws InputError where the device's port cannot be opened.
  explicit FingerChain(const FingerChainOptions& options);

  /// Step 0, see FingerLoop; sealed.
  const StepRecord& start(const TrackedInput& tracked);
  /// Step `step` (from 1, one after the other).
  void step(std::int64_t step, const TrackedInput& tracked);
  /// The same in two parts, see FingerLoop; see SceneLoop for who calls them.
  bool begin_step(std::int64_t step, const TrackedInput& tracked);
  void end_step(const StepSummary& summary, FingerLoop::SolvingTime solving, std::uint64_t world);
  /// Whether a device tick falls in the last step; never without a device.
  [[nodiscard]] bool tick_is_due() const { return tick_is_due_; }
  /// About the last step, which took its pose at `taken` and hands its contact on now.
  [[nodiscard]] TickInput tick_input(std::chrono::steady_clock::time_point taken) const;
  /// The skin after the last step.
  [[nodiscard]] VirtualFinger virtual_finger() const;
  /// A tick of the last step, here and now; the step knows it. Only with a device.
  const TickRecord& tick(const TickInput& input);
  /// A tick of a step that was handed over.
  const TickRecord& tick(const TickInput& input, const VirtualFinger& finger);
  /// From here on steps name this tick as the newest that they know.
  void know(std::int64_t tick, std::uint64_t hash);
  /// Completes the record of the last step.
  const StepRecord& seal();
  /// Retracts the device, see Actuator::finish(). Blocks for that time.
  void finish() noexcept;

  [[nodiscard]] const FingerLoop& loop() const { return loop_; }
  [[nodiscard]] FingerSimulation& simulation() { return loop_.simulation(); }
  [[nodiscard]] bool has_device() const { return device_ != nullptr; }
  /// Only with a device.
  [[nodiscard]] DeviceLoop& device() { return *device_; }
  [[nodiscard]] const DeviceLoop& device() const { return *device_; }

 private:
  FingerLoop loop_;
  DeviceClock clock_;
  std::unique_ptr<DeviceLoop> device_;  ///< null: none
  bool tick_is_due_ = false;
  std::uint64_t world_ = 0;       ///< hash of what moves beside the finger
  std::int64_t known_tick_ = -1;  ///< newest known to the steps; -1: none
  std::uint64_t known_hash_ = 0;
};

}  // namespace softfinger
