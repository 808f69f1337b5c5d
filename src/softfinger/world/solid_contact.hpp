#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/finger/obstacle_coupling.hpp"
#include "softfinger/geometry/surface_points.hpp"

namespace softfinger {

/// Potential energy of rigid objects that touch each other, of which at least one moves: lasting
/// points of each, small balls at its corners and edges, against the distance of the other; where
/// both have points, both ways at half the stiffness. All is a function of where a point of one
/// object is in the frame of the other, so forces and moments cancel to rounding.
///
/// Normal contact is a stiff penalty as of skin (contact_potential.hpp), stiff enough to rest
/// within micrometres whatever the mass: k = max(kStiffness m / h^2, kLeastForce / kDepth),
/// m the greatest mass.
/// Friction is a Huber potential of the slip since contact began, carried along from step to step,
/// so that what is held stays; its limit is that of the normal force at the end of the last step,
/// see update_limits().
///
/// Of a rim that leans the two points next to its deepest place are there in each step, as it is
/// expected, and share what it bears: else what rolls would roll on a polygon. On what is round
/// itself they may bear less, down to nothing midway; then the other object's own points bear it.
///
/// Bones of hands bear as an elastic foundation instead: a ball of one has the stiffness of the
/// strip that it stands for, and only the other object's distance is looked at.
///
/// What touches is shared out to islands, which are evaluated each by itself, on any thread.
///
/// What is deeper inside another at the start of a step than it could part in it at kParting is let
/// be there so far: objects that start inside each other, and bones of a hand that appear inside
/// something, part at that speed.
class SolidContact {
 public:
  static constexpr double kStiffness = 10.0;
  static constexpr double kLeastForce = 1.0;  ///< N
  static constexpr double kDepth = 5e-6;      ///< m
  static constexpr double kParting = 50e-3;   ///< m/s

  /// Who touches whom. masses: kg, by object; 0: it does not move by forces. `apart`: pairs that do
  /// not touch, such as a jointed object and its parent.
  SolidContact(std::span<const VirtualObject> objects, std::span<const double> masses,
               std::span<const std::array<int, 2>> apart, double time_step);

  /// What an object does in a step. Two that lie keep what they remember of each other; what is
  /// nowhere touches nothing.
  enum class Motion : std::uint8_t { kLies, kStirs, kAbsent };
  /// Objects stand at X_WO at the start of the step and are expected at X_WO_expected.
  void begin(std::span<const Pose> X_WO, std::span<const Pose> X_WO_expected,
             std::span<const Motion> motions);
  /// Calls meet(object, object) for all that may touch in this step, once a point.
  template <typename Visitor>
  void for_each_near(const Visitor& meet) const {
    for (std::size_t k = 0; k < candidate_count_; ++k) meet(candidates_[k].of, candidates_[k].on);
  }
  /// How many points that are.
  [[nodiscard]] std::size_t near_count() const { return candidate_count_; }
  /// Memory for so many islands.
  void reserve(std::size_t islands) { starts_.reserve(islands + 1); }
  /// What belongs to which of so many islands; by object, -1: to that of the other.
  void share_out(std::span<const int> island_of_object, std::size_t islands);
  /// Nothing has touched.
  void reset();
  /// The object has touched nothing.
  void forget(std::size_t object);

  /// Calls visit(of, on, depth in m) for each point that is further inside at the start of the step
  /// than the step can part.
  template <typename Visitor>
  void for_each_sunk(const Visitor& visit) const {
    for (std::size_t k = 0; k < candidate_count_; ++k) {
      const Candidate& c = candidates_[k];
      if (c.allowed < 0.0) visit(c.of, c.on, parting_ - c.allowed);
    }
  }

  struct Sum {
    double energy = 0.0;         ///< J
    double squared_force = 0.0;  ///< of all points, N^2
  };
  /// Of an island with the objects there. wrenches: derivative by the translation of each object's
  /// origin and its rotation, W; added to, of those that move by forces.
  Sum evaluate(std::size_t island, std::span<const Pose> X_WO, std::span<Vector6> wrenches);
  /// Of all points that touched the object, one that moves by forces, at the last evaluation, N/m;
  /// 0: none did.
  [[nodiscard]] double stiffness(std::size_t object) const { return touched_[object]; }

  /// One point of an object against another as last evaluated.
  struct Touch {
    std::size_t of = 0, on = 0;           ///< objects: the point is one of `of`
    Vector3 at = Vector3::Zero();         ///< where the force acts, W
    Matrix3 stiffness = Matrix3::Zero();  ///< second derivative by the point's position on `on`
  };
  /// Calls touch(Touch) for all of an island that do something to each other, those of two objects
  /// one after the other.
  template <typename Visitor>
  void for_each_touch(std::size_t island, const Visitor& visit) const {
    for (const std::size_t k : of_island(island)) {
      const Candidate& c = candidates_[k];
      if (c.pressing > 0.0) visit(Touch{c.of, c.on, c.centre_W, c.normal_stiffness});
      if (c.limit > 0.0) visit(Touch{c.of, c.on, c.material_W, c.friction_stiffness});
    }
  }

  /// Calls press(object, object, normal force in N) for all points that press at the last
  /// evaluation.
  template <typename Visitor>
  void for_each_pressing(const Visitor& press) const {
    for (std::size_t k = 0; k < candidate_count_; ++k) {
      const Candidate& c = candidates_[k];
      if (c.pressing > 0.0) press(c.of, c.on, c.pressing);
    }
  }

  /// Calls meet(object, object) for all of an island that may touch in this step, once a point.
  template <typename Visitor>
  void for_each_near(std::size_t island, const Visitor& meet) const {
    for (const std::size_t k : of_island(island)) meet(candidates_[k].of, candidates_[k].on);
  }

  [[nodiscard]] bool is_in_cone(std::size_t island) const;
  /// Sum of all friction last evaluated beyond the cone of the normal forces, N.
  [[nodiscard]] double beyond_cone(std::size_t island) const;
  /// Friction limits from the normal forces last evaluated, `overshoot` as ContactPotential's.
  void update_limits(std::size_t island, bool only_lower, double overshoot);
  /// Added to `moments` (W, N m, by object): how much less friction turned each object about a
  /// point of it (`pivots_O`, by object) half way through the step than at its end, as last
  /// evaluated.
  void add_turn_half_way(std::span<const Pose> X_WO_start, std::span<const Pose> X_WO,
                         std::span<const Vector3> pivots_O, std::span<Vector3> moments) const;
  /// The step has ended as last evaluated.
  void end(std::span<const Pose> X_WO);

  /// Whether an object may touch another in this step.
  [[nodiscard]] bool is_near(std::size_t object) const { return near_[object] != 0; }
  /// Whether an object touched another at the last evaluation.
  [[nodiscard]] bool touches(std::size_t object) const { return touched_[object] > 0.0; }
  /// Sum of normal forces between two objects at the last evaluation, N.
  [[nodiscard]] double normal_force(std::size_t a, std::size_t b) const;

  /// What the next step depends on of an object's own points.
  template <typename Hash>
  void add_to(Hash& hash, std::size_t object) const {
    if (remembered_[object] == 0) return;
    for (const std::array<Memory, kPartners>& point : memories_[object]) {
      for (const Memory& memory : point) {
        if (memory.on < 0) continue;
        hash.add(memory.on).add(memory.slip_O).add(memory.normal_O).add(memory.limit);
        hash.add(memory.began_inside ? 1 : 0);
      }
    }
  }

 private:
  static constexpr std::size_t kPartners = 3;
  /// What a point remembers of an object that it touched at the end of the last step.
  struct Memory {
    int on = -1;
    Vector3 slip_O = Vector3::Zero();  ///< in the frame of that object, m
    Vector3 normal_O = Vector3::UnitZ();
    double limit = 0.0;         ///< N
    bool began_inside = false;  ///< of a bone of a hand
  };
  /// A point that may touch in this step.
  struct Candidate {
    std::size_t of = 0, on = 0, point = 0;
    Vector3 centre_O = Vector3::Zero();  ///< of the ball, in the frame of `of`
    double stiffness = 0.0;              ///< N/m
    double friction_coefficient = 0.0;
    double allowed = 0.0;       ///< gap that is let be, at most 0, m
    bool began_inside = false;  ///< of a bone of a hand: before it touched
    // Of friction: the point of the surface of `of` that touched, and where it was without slip.
    double limit = 0.0;
    Vector3 material_of = Vector3::Zero();  ///< in the frame of `of`
    Vector3 free_on = Vector3::Zero();      ///< in that of `on`
    Vector3 normal_on = Vector3::UnitZ();
    // As last evaluated.
    double gap = 0.0, pressing = 0.0;
    Vector3 normal = Vector3::UnitZ();  ///< W, out of `on`
    Vector3 centre_W = Vector3::Zero(), material_W = Vector3::Zero();
    Vector3 slip = Vector3::Zero();            ///< W
    Vector3 friction_force = Vector3::Zero();  ///< on `of`
    Matrix3 normal_stiffness = Matrix3::Zero(), friction_stiffness = Matrix3::Zero();
  };
  struct Pair {
    std::size_t of = 0, on = 0;
    double stiffness = 0.0, friction_coefficient = 0.0;
    double foundation = 0.0;  ///< instead of the stiffness, where `of` is of a hand, N/m^3
  };
  void add_hand_pairs(std::size_t a, std::size_t b, double friction, double stiffness);
  void add_candidates(const Pair& pair, std::span<const Pose> X_WO,
                      std::span<const Pose> X_WO_expected);
  double evaluate(Candidate& candidate, std::span<const Pose> X_WO) const;
  [[nodiscard]] std::span<const std::size_t> of_island(std::size_t island) const {
    return {shared_.data() + starts_[island], starts_[island + 1] - starts_[island]};
  }
  [[nodiscard]] double friction_stiffness(const Candidate& c) const;
  void forget(std::size_t of, Memory& memory);
  [[nodiscard]] Memory* memory_of(std::size_t of, std::size_t point, std::size_t on);

  std::span<const VirtualObject> objects_;
  std::vector<std::vector<SurfacePoint>> points_;  ///< by object
  std::vector<Eigen::AlignedBox3d> bounds_;        ///< by object, O
  std::vector<Pair> pairs_;
  std::vector<std::vector<std::array<Memory, kPartners>>> memories_;  ///< by object and point
  std::vector<Candidate> candidates_;
  std::size_t candidate_count_ = 0;
  std::vector<std::size_t> shared_, starts_;  ///< candidates by island
  std::vector<std::uint8_t> moves_;           ///< by object: forces move it
  std::vector<std::size_t> remembered_;       ///< by object: of its points, how often they touch
  double parting_;                            ///< in a step, m
  std::vector<std::uint8_t> near_;            ///< by object
  std::vector<double> touched_;               ///< by object: stiffness, N/m
};

}  // namespace softfinger
