#pragma once

#include <span>
#include <utility>
#include <vector>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/numerics/newton.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/body_cholesky.hpp"
#include "softfinger/world/body_forces.hpp"
#include "softfinger/world/partner.hpp"
#include "softfinger/world/soft_contact.hpp"
#include "softfinger/world/solid_contact.hpp"

namespace softfinger {

/// What a world and all its islands share.
struct WorldParts {
  const BodyTree& tree;
  std::vector<BodyMotion>& motions;  ///< by body
  BodyForces& forces;
  SolidContact& contact;
  SoftContact& soft;
  std::vector<Partner>& partners;
  std::vector<Pose>& X_WO;         ///< by object: where it is at the end of the step
  std::vector<BodyPlace>& places;  ///< by body: where it is expected then, and in the end is
};

/// Which of them hang together.
struct Island {
  std::size_t number = 0;  ///< as contact was shared out
  std::span<const std::size_t> bodies;
  std::span<Partner* const> partners;
  bool is_soft = false;  ///< something soft is among them
};

/// One step of an island, objects that move and the fingers that may touch them, as one potential:
/// that of each finger, inertia, weight and joints of each body, and contact between objects. It is
/// a problem for minimise_island(). Soft objects are fingers without a hand here. One problem
/// serves one island after the other; several may serve different islands at once, of which one may
/// be soft. Allocates nothing after its making.
///
/// The matrix is an arrowhead: each finger's factor A_f with its contact blocks held, columns B_f
/// by the coordinates of the bodies it touches, and the bodies' own D. With Z_f = A_f^-1 B_f the
/// bodies move by S xi = -g + sum B_f^T A_f^-1 g_f, S = D - sum B_f^T Z_f, and each finger by d_f =
/// -A_f^-1 g_f - Z_f xi. S has a block for each two bodies that touch, hang together or are touched
/// by one finger, see BodyCholesky. Contact with soft objects is in none of these, see SoftContact:
/// with H for the whole of the arrowhead, it takes W = G H^-1 G^T.
class IslandProblem {
 public:
  /// The parts must outlive it.
  explicit IslandProblem(const WorldParts& parts);
  /// For the partners that there are now; `soft`: something among them is.
  void reserve(bool soft);

  /// Minimisation starts where the parts' places are, at the end of the step, `time` (s). Fingers
  /// have begun theirs; spans must outlive the step. `team` shares the fingers' work; null: none.
  void begin(const Island& island, double time, ThreadTeam* team);
  /// The parts' places are those found.
  void end();
  /// Evaluations since begin().
  [[nodiscard]] int evaluations() const { return evaluations_; }

  // What minimise_island() asks for.
  [[nodiscard]] double energy() const { return current_.energy; }
  [[nodiscard]] double residual() const { return current_.residual; }
  [[nodiscard]] bool has_factor() const;
  [[nodiscard]] bool factorise(HessianKind kind);
  double solve_direction(bool refined);
  void evaluate_trial(double t);
  [[nodiscard]] double trial_energy() const { return trial_.energy; }
  [[nodiscard]] double trial_residual() const { return trial_.residual; }
  void accept_trial();
  void settle();
  void renew();
  [[nodiscard]] bool is_tangled() const;
  void limit_strain(bool limited);
  [[nodiscard]] bool is_in_cone() const;
  /// Sum of all friction beyond the cone of the normal forces, N.
  [[nodiscard]] double beyond_cone() const;
  void update_limits(bool only_lower, double overshoot = ContactPotential::kOvershoot);

 private:
  /// Vectors by body and by coordinate are those of all; what is not the island's is left alone.
  struct Point {
    std::vector<BodyPlace> places;
    std::vector<double> gradient;
    double energy = 0.0, residual = 0.0;
  };
  template <typename Work>
  void for_each_partner(const Work& work);
  using At = FingerPotential::At;
  void evaluate_fingers(At at);
  void show(std::span<const BodyPlace> places);
  /// Of what the fingers have evaluated, and the rest at point.places.
  void evaluate(Point& point);
  void add_bodies(Point& point, double squared_contact_force);
  [[nodiscard]] bool pairs_may_meet() const { return is_soft_ && parts_.soft.any(); }

  // The matrix, see island_direction.cpp.
  void arrange_system();
  void couple(std::size_t a, std::size_t b);
  bool build_system();
  void add_contact();
  void add_pair(std::size_t a, std::size_t b, const Matrix6& block);
  void solve_system(std::span<double> by_coordinate);
  void correct_directions();
  /// The directions with contact of soft surfaces.
  void bend_to_soft_contact(bool refined);
  [[nodiscard]] Vector6 twist_of(std::size_t body) const;

  WorldParts parts_;
  ThreadTeam* team_ = nullptr;
  std::size_t number_ = 0;
  std::span<const std::size_t> bodies_;
  std::span<Partner* const> partners_;
  bool is_soft_ = false;
  std::vector<std::uint8_t> taking_part_;  ///< by partner
  double time_ = 0.0;
  int evaluations_ = 0;

  std::vector<Vector6> wrenches_;           ///< by object
  std::vector<BodyTree::Columns> columns_;  ///< by body, as last evaluated
  Point current_, trial_;
  std::vector<BodyPlace> expected_;
  std::vector<double> direction_, recoil_;  ///< by coordinate
  bool cache_is_current_ = false;
  BodyCholesky system_;
  bool system_is_current_ = false;
  std::vector<int> block_of_coordinate_;  ///< of those of the island
  std::vector<int> first_of_coordinate_;  ///< the first coordinate of its block
  std::vector<int> freedoms_;             ///< by block
  std::vector<double> side_;              ///< six a block
  Eigen::MatrixXd pulled_, yielding_;  ///< coordinates by pairs of soft contact, and their motion
};

template <typename Work>
void IslandProblem::for_each_partner(const Work& work) {
  share(team_, partners_.size(), [&](std::size_t p, int) { work(*partners_[p]); });
}

}  // namespace softfinger
