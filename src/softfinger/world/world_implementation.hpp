#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/world/body_rest.hpp"
#include "softfinger/world/body_start.hpp"
#include "softfinger/world/island_problem.hpp"
#include "softfinger/world/islands.hpp"
#include "softfinger/world/soft_body.hpp"
#include "softfinger/world/world.hpp"

namespace softfinger {

class ThreadTeam;

/// A step's state and parts. Bodies, objects, soft objects and partners go by their own numbers.
struct World::Implementation {
  Implementation(std::span<const VirtualObject> things, const Vector3& g, double dt,
                 ThreadTeam* helpers);
  using Stir = SolidContact::Motion;

  // Beginning and end of steps, and what is told of them (world.cpp).
  void add(FingerSimulation& finger, int object = -1);
  /// For the partners that there are.
  void reserve();
  void start();
  void tell();
  void tell_soft(std::size_t s) { states[softs[s]->object()] = softs[s]->state(); }
  /// Soft objects that are awake begin, and all that may touch their surfaces knows where; once
  /// more in the same step where others have woken.
  void begin_softs(double end);
  void end();

  // What sleeps, and what moves smoothly (world_rest.cpp).
  /// Number of a soft object among what rests and hangs together: after the bodies, as partners.
  [[nodiscard]] std::size_t number_of_soft(std::size_t s) const { return motions.size() + s; }
  [[nodiscard]] bool sleeps_soft(std::size_t s) const { return rest.sleeps(number_of_soft(s)); }
  [[nodiscard]] bool sleeps(const Partner& partner) const {
    return partner.number < softs.size() && sleeps_soft(partner.number);
  }
  /// Whether a body takes part in steps: it does not sleep, and is somewhere.
  [[nodiscard]] bool acts(std::size_t b) const { return !rest.sleeps(b) && !forces.is_nowhere(b); }
  /// Islands without fingers that have been at rest for long fall asleep.
  void look_for_rest();
  /// Anything that a body, or what hangs together with it, touches makes its motion rough.
  void count_quiet();
  bool roughen();
  /// To all that hang together.
  void spread_roughness();

  // Where all is expected, and who is near whom then (world_nearness.cpp).
  void expect(double end);
  /// Where bodies are expected, and who is near whom; wakes what something comes near that stirs.
  void predict_awake(double end);
  void predict(double end);
  /// Fingers and soft objects wake what they come near, and what stirs soft objects.
  bool wake_near_partners();
  /// Whether a script moves what its joint hangs on in this step.
  [[nodiscard]] bool hangs_on_moving(std::size_t b) const;
  void put_boxes();
  /// Of partners: the soft objects come first.
  [[nodiscard]] std::span<const Partner> those_of_fingers() const;
  /// Whether one of some partners comes near the rigid object in this step, awake.
  [[nodiscard]] bool is_near(std::size_t object, std::span<const Partner> some) const;
  /// Whether a soft object is moved, or something comes near it, that no forces of its island move.
  [[nodiscard]] bool is_disturbed(std::size_t s) const;
  /// Whether something rigid stirs near a soft object.
  [[nodiscard]] bool stirs_near(std::size_t s, std::size_t object) const;
  /// Whether anything that stirs comes near a soft object that sleeps.
  [[nodiscard]] bool is_met(std::size_t s) const;
  /// Whether an object comes into the box in this step.
  [[nodiscard]] bool reaches(const Eigen::AlignedBox3d& box, std::size_t object) const;

  // What is solved by itself (world_islands.cpp).
  /// Who hangs together in this step, with these fingers and all that is soft.
  void find_islands(std::span<FingerSimulation* const> stepped);
  /// What is to be solved by itself, and how that ended.
  struct Task {
    Island island;
    StepSummary summary;
    long evaluations = 0;
  };
  void make_tasks();
  void solve(Task& task, IslandProblem& problem, ThreadTeam* helpers);
  /// Islands of many fingers one after the other, the work of each shared out; the others side by
  /// side. A finger that is alone may share its own work out, and is not one of these.
  void solve_tasks();

  // Overlaps and events (world_reports.cpp).
  void find_overlaps();
  /// What has come into being since the last step, inside something.
  void find_appeared();
  void note_overlap(const Overlap& found);
  void prepare_events();
  void tell_events();

  std::span<const VirtualObject> objects;
  double time_step;
  ThreadTeam* team;
  BodyTree tree;
  SolidContact contact;
  BodyForces forces;
  SoftContact soft_contact;
  BodyRest rest;
  std::vector<BodyMotion> motions;
  std::vector<BodyPlace> places;
  std::vector<Pose> poses, expected;  ///< of objects, at the start of the step and at its end
  std::vector<ObjectState> states;
  std::vector<Stir> stirs;            ///< by object
  std::vector<int> island_of_object;  ///< -1: none
  /// By body: steps without contact, after kSmoothAfter of which motion counts as smooth.
  std::vector<int> quiet;
  static constexpr int kSmoothAfter = 2;
  std::vector<std::unique_ptr<SoftBody>> softs;
  std::vector<std::uint8_t> has_begun;                   ///< by soft object: its step
  std::vector<Partner> partners;                         ///< what is soft, then the fingers
  std::vector<std::unique_ptr<IslandProblem>> problems;  ///< by thread
  std::vector<FingerSimulation*> fingers, near;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< about each partner
  std::vector<std::uint8_t> takes_part;    ///< by partner
  Islands islands;
  std::vector<Task> tasks;  ///< an island each
  std::vector<std::size_t> shared_tasks;
  std::vector<Partner*> of_tasks;
  double time = 0.0;
  std::optional<WorldEvents> events;
  std::vector<Overlap> overlaps;
  /// By object: the point that a body's angular momentum is about, and what friction turned it by,
  /// see SolidContact::add_turn_half_way().
  std::vector<Vector3> pivots_O, half_way;
  std::vector<std::uint8_t> appeared;  ///< by object: a bone, since the last step
  StepSummary last;
  StepWork work;
};

}  // namespace softfinger
