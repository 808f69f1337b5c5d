#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "softfinger/recording/record.hpp"
#include "softfinger/session/live_feed.hpp"
#include "softfinger/threads/mailbox.hpp"
#include "softfinger/twin/skin_comparison.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// The twin of one finger in a live run: pressed with the newest command on a thread of its own,
/// which all others go before, and judged against the virtual contact that led to it. For eyes
/// alone: nothing of it comes back to the loop, and commands it is too slow for are skipped.
class LiveTwin {
 public:
  /// `wearer` may be any finger; what it feels is shown on the model's samples.
  LiveTwin(const std::shared_ptr<const FingerModel>& model,
           const std::shared_ptr<const FingerModel>& wearer,
           const std::shared_ptr<const Device>& device);
  /// Ends as end() does.
  ~LiveTwin();
  LiveTwin(const LiveTwin&) = delete;
  LiveTwin& operator=(const LiveTwin&) = delete;

  void start();
  /// Waits for the press under way.
  void end();

  /// A command with the contact it was matched to. One thread; wait-free, allocates nothing.
  void offer(const TickRecord& tick, const ContactSet& contact);
  /// Takes over the newest press if there is one not yet taken. One thread; wait-free.
  bool refresh() { return presses_.refresh(); }
  /// The press last taken; vectors have their full size from the start.
  [[nodiscard]] const Snapshot::Twin& latest() const { return presses_.latest(); }

 private:
  struct Offer {
    double time = 0.0;  ///< s, of the tick
    Configuration configuration;
    ContactSet contact;
  };

  void serve();
  void press(const Offer& offer);

  /// The wearer's skin at the places of the model's samples.
  void show(const ContactSet& contact, Snapshot::Skin& skin) const;

  Twin twin_;
  SkinComparison comparison_;
  std::vector<SkinPlace> shown_;  ///< the wearer's, one per sample of the model
  double time_ = 0.0;             ///< s, of the last press
  Mailbox<Offer> offers_;
  Mailbox<Snapshot::Twin> presses_;
  std::atomic<std::uint32_t> doorbell_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
