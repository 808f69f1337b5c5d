#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/finger_simulation.hpp"

namespace softfinger {

class ThreadTeam;

/// Contact of fingers and soft objects with the surfaces of soft objects, within a step: each
/// sample that may meet such a surface is a pair with the three nodes of its patch, whose energy
/// depends only on the way between them. What bodies' own factors A leave out of it the direction
/// has by a small system: with G the way of the pairs by the unknowns, W = G A^-1 G^T and f the
/// forces of the pairs, the way is G d = G d_0 - W (f(G d) - f(0)). Cost and accuracy do not depend
/// on how stiff contact is, and no factor on who touches.
class SoftContact {
 public:
  /// More are left out of the direction, which then takes longer to lead to the same end.
  static constexpr std::size_t kMostPairs = 128;

  /// One more body that may touch; the number of the scene's object that it is, -1: a finger. Soft
  /// objects first.
  void add(FingerSimulation& body, int object);
  /// Nothing is known of factors.
  void forget();
  /// A step begins, of these bodies (numbers as added) alone.
  void begin(std::span<const std::uint8_t> taking_part);
  /// Whether any two may touch in this step.
  [[nodiscard]] bool any() const { return any_; }

  using At = FingerPotential::At;
  /// Patches stand where the nodes of their surfaces do.
  void follow(At at);
  /// What has been met last loads the nodes of soft objects.
  void hand_over();

  /// A body has been factored anew.
  void forget_factor(std::size_t body);
  /// The pairs that press, stick or may do so along the bodies' directions as they are, and W.
  /// False where there is none.
  bool find_pairs(ThreadTeam* team);
  [[nodiscard]] std::size_t size() const { return pairs_.size(); }
  /// Way of a pair in a direction of one body's unknowns, m.
  [[nodiscard]] Vector3 way(std::size_t pair, std::size_t body,
                            std::span<const double> unknowns) const;
  /// W: rows and columns three a pair. Others may yield too.
  [[nodiscard]] Eigen::Ref<Eigen::MatrixXd> compliance();
  /// Finds how much the pairs' forces change, by rows as of compliance(). Else than `refined` as
  /// they would if they went on as they begin: then the directions lead down.
  std::span<const double> balance(bool refined);
  /// d -= A^-1 G^T times that.
  void apply(std::size_t body);

 private:
  struct Term {
    std::size_t body = 0;
    int node = 0;
    double weight = 0.0;
  };
  struct Pair {
    std::size_t toucher = 0, object = 0, sample = 0;
    std::array<Term, 4> terms;
    Vector3 start = Vector3::Zero();     ///< way along the directions without it, m
    Vector3 gradient = Vector3::Zero();  ///< where directions start, N
  };
  /// How nodes of a factored body yield to forces on each other, columns three a node.
  struct Yielding {
    std::vector<int> slot_of_node;  ///< -1: not known
    std::vector<int> nodes;
    Eigen::MatrixXd compliance;
    std::vector<std::vector<double>> columns;
  };
  struct Body {
    FingerSimulation* simulation = nullptr;
    int object = -1;
    bool taking_part = false;
    Yielding yielding;
    std::vector<double> response;
  };
  void reserve_pairs();
  void add_pairs(std::size_t toucher, std::size_t soft, bool pressing);
  void learn(std::size_t body);
  void learn_nodes(Body& body, std::span<const int> nodes);
  void build_compliance();
  /// Changes of force at these ways; returns how far the ways are from what these leave.
  double evaluate(const Eigen::VectorXd& ways, bool refined);
  void look_at(const Eigen::VectorXd& ways);
  /// The ways that would be left where forces change as they do at `ways`.
  void solve(const Eigen::VectorXd& ways, Eigen::VectorXd& better);

  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  bool any_ = false;
  Eigen::MatrixXd compliance_;
  Eigen::VectorXd starts_, ways_, better_, trial_, forces_, excess_, rest_;
  std::vector<Matrix3> stiffness_;    ///< by pair
  std::vector<std::size_t> stiff_;    ///< pairs with any
  std::vector<Matrix3> roots_;        ///< of their stiffness
  std::vector<float> factor_, side_;  ///< three rows and columns a stiff pair
};

}  // namespace softfinger
