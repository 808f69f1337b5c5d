// A motion as somebody sends it over a network, in simulated time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include "softfinger/tracking/stream/pose_feed.hpp"
#include "softfinger/tracking/stream/sender_clock.hpp"

namespace softfinger {

/// How poses are taken, stamped and carried. Jitters are uniform.
struct Sending {
  double rate = 120.0;        ///< Hz
  double way = 1e-3;          ///< s, the shortest from the sender to here
  double way_jitter = 0.0;    ///< s, what it may take beyond that
  double stamp_jitter = 0.0;  ///< s, how far a time stamp may be from when the pose was true
  bool stamped = true;        ///< false: a pose counts as old as its arrival
  double loss = 0.0;          ///< probability
  double until = 1e9;         ///< s, nothing is sent from then on
  std::uint64_t seed = 1;
};

/// What a run's tracker of such a sender gives to a loop that samples it in even steps.
class SentMotion final : public Tracker {
 public:
  using Motion = std::function<Pose(double time)>;
  SentMotion(Motion motion, const Sending& sending)
      : motion_(std::move(motion)), sending_(sending), random_(sending.seed) {}

  TrackedPose sample(double time) override {
    for (double taken = 0.0; (taken = next_ / sending_.rate) <= time && taken < sending_.until;) {
      send(next_++, taken);
    }
    while (!coming_.empty() && coming_.begin()->first <= time) {
      hear(coming_.begin()->second, kStart + coming_.begin()->first);
      coming_.erase(coming_.begin());
    }
    return feed_.sample(time, kStart + time);
  }
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  struct Message {
    int number = 0;
    Pose X_WFt;
    double stamp = 0.0;  // s, the sender's clock
  };
  static constexpr double kStart = 1000.0;  // s of the monotonic clock, start of the run
  static constexpr double kAhead = 77.0;    // s, the sender's clock

  double chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  void send(int number, double taken) {
    const double stamp = taken + sending_.stamp_jitter * (2.0 * chance() - 1.0);
    const double arrival = taken + sending_.way + sending_.way_jitter * chance();
    if (chance() < sending_.loss) return;
    coming_.emplace(arrival, Message{number, motion_(taken), kAhead + stamp});
  }
  void hear(const Message& message, double now) {
    if (message.number <= heard_) return;  // overtaken
    heard_ = message.number;
    feed_.offer(message.X_WFt, sending_.stamped ? clock_.local_time(message.stamp, now) : now, now);
  }

  Motion motion_;
  Sending sending_;
  std::mt19937_64 random_;
  PoseFeed feed_;
  SenderClock clock_;
  std::multimap<double, Message> coming_;
  int next_ = 0;
  int heard_ = -1;
};

}  // namespace softfinger
