#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/world/body_tree.hpp"

namespace softfinger {

/// Which bodies sleep, rigid and soft ones. Those of an island that have all been at rest for
/// kRestTime fall asleep together, and wake together: none of their points, and no joint's, was
/// further than kRestWay from where it was when the time began, nor is faster than kRestSpeed at
/// its end.
class BodyRest {
 public:
  static constexpr double kRestTime = 0.5;    ///< s
  static constexpr double kRestWay = 1e-7;    ///< m
  static constexpr double kRestSpeed = 1e-5;  ///< m/s

  BodyRest(std::size_t bodies, double time_step);
  /// All are awake, and move.
  void reset();

  [[nodiscard]] bool sleeps(std::size_t b) const { return groups_[b] >= 0; }
  [[nodiscard]] std::size_t sleeping() const { return sleeping_; }
  /// The body's whole group.
  void wake(std::size_t b);
  /// A step has ended with a body, awake, there; `reach` of its surface from O's origin, m; `speed`
  /// of its fastest point, m/s.
  void look(std::size_t b, const Pose& X_WO, double reach, double speed);
  /// The same of what knows itself where it was: its furthest point is `way` from there, m. True
  /// where its time begins anew, where it is now.
  bool look(std::size_t b, double way, double speed);
  /// Something has moved or may move it: its time begins anew.
  void disturb(std::size_t b) { times_[b].steps = 0; }
  [[nodiscard]] bool has_rested(std::size_t b) const { return times_[b].steps >= rest_steps_; }
  /// An island's bodies, awake, sleep from now on.
  void fall_asleep(std::span<const std::size_t> bodies);

  template <typename Hash>
  void add_to(Hash& hash, std::size_t b) const {
    hash.add(groups_[b]).add(times_[b].steps);
    hash.add(times_[b].since.rotation).add(times_[b].since.translation);
  }

 private:
  /// How long it has been at rest, and where it began to be.
  struct Time {
    int steps = 0;
    Pose since;
  };
  int rest_steps_;
  std::size_t sleeping_ = 0;
  std::vector<int> groups_;  ///< the least number of those that fell asleep together; -1: awake
  std::vector<Time> times_;
};

}  // namespace softfinger
