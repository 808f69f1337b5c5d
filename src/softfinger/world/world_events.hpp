#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "softfinger/world/force_curve.hpp"

namespace softfinger {

enum class EventKind { kImpact, kRelease, kClick, kDetent, kLimit };

/// "impact", "release", "click", "detent", "limit".
[[nodiscard]] const char* event_name(EventKind kind);

struct WorldEvent {
  double time = 0.0;  ///< s, end of the step in which it happened
  EventKind kind = EventKind::kImpact;
  int object = 0;   ///< its number in the scene
  int other = -1;   ///< likewise; a finger's number counts on from the objects; -1: none
  double impulse =  ///< N s; NaN: none
      std::numeric_limits<double>::quiet_NaN();
};

/// What happens to objects that move, from what every step says of them:
///
///     impact    two begin to touch that did not for kApart; with the impulse of the normal force
///     in
///               kBlow from then. What touches in the first step did so before.
///     release   they have not touched for kApart
///     click     a slider passes the top of its force curve inwards, or the valley outwards; with
///               the momentum that it gains until the force rises again, if that is within kApart
///     detent    the rest position nearest to a knob is another
///     limit     a joint meets its limit after kApart away from it; a slider with the impulse in
///               kBlow
///
/// They are told in the order of time, once their impulses are known: up to kApart later. Allocates
/// nothing after its making; beyond kMostOpen at once they are not told.
class WorldEvents {
 public:
  static constexpr double kApart = 20e-3;  ///< s
  static constexpr double kBlow = 10e-3;   ///< s
  static constexpr std::size_t kMostOpen = 1024;

  /// A joint with a coordinate.
  struct Joint {
    int object = 0;
    double mass = 0.0;                        ///< of what a slider moves, kg; 0: a hinge
    std::span<const ForceCurve::Snap> snaps;  ///< must outlive the events
  };
  /// `moving`: numbers of the objects that move; time_step in s.
  WorldEvents(std::span<const int> moving, std::size_t objects, std::size_t fingers,
              std::span<const Joint> joints, double time_step);
  void reset();

  /// Normal force between two in this step, N; adds up. One of them moves.
  void touch(int object, int other, double normal_force);
  /// An object lies as it did: what touched it still does, and nothing else.
  void lie(int object);
  /// A joint at the end of this step.
  struct JointState {
    double q = 0.0;            ///< m or rad
    double limit_force = 0.0;  ///< of its limits, N or N m
    long detent = 0;
  };
  void joint(std::size_t joint, const JointState& state);
  /// All of the step was said.
  void end_step();
  /// No step follows: all that is open is told as far as it is known.
  void finish();
  /// What the last step, or the end, tells.
  [[nodiscard]] std::span<const WorldEvent> told() const { return told_; }

 private:
  /// Two things, or a joint and its limit, that touch now and then.
  struct Meeting {
    std::int64_t last = kNever;  ///< step in which they touched
    bool together = false;       ///< since they met, and not yet released
    double force = 0.0;          ///< in this step
  };
  static constexpr std::int64_t kNever = -1;
  struct Passed {
    bool top = false, valley = false;
  };
  struct JointMemory {
    Joint joint;
    JointState now, before;
    double momentum = 0.0, old_momentum = 0.0;  ///< along q, N s
    Meeting limit;
    std::vector<Passed> passed;  ///< by snap
  };
  struct Open {
    WorldEvent event;
    std::int64_t until = 0;       ///< the last step that counts
    const Meeting* of = nullptr;  ///< whose force adds up
    // Of a click.
    const JointMemory* joint = nullptr;
    std::size_t snap = 0;
    bool inwards = false;
    double momentum = 0.0;  ///< before
    bool is_over = false;
  };

  /// Whether they begin to touch, with the meeting brought up to this step; `released`: they have
  /// not for kApart.
  bool meets(Meeting& meeting, bool& released) const;
  void end_pairs();
  void end_joint(JointMemory& memory);
  void find_clicks(JointMemory& memory);
  Open* open(EventKind kind, int object, int other, std::int64_t steps);
  void follow(Open& open) const;
  void follow_click(Open& open) const;
  void tell();

  std::size_t others_;
  double time_step_;
  std::int64_t apart_, blow_;  ///< steps
  std::vector<int> moving_;
  std::vector<std::uint8_t> lies_;  ///< by row
  std::vector<int> row_of_;         ///< by object; -1: it does not move
  std::vector<Meeting> meetings_;   ///< by row and other
  std::vector<JointMemory> joints_;
  std::vector<Open> open_;
  std::vector<WorldEvent> told_;
  std::int64_t step_ = 1;
};

}  // namespace softfinger
