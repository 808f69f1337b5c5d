#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/fem/elastic_model.hpp"
#include "softfinger/numerics/block_cholesky.hpp"

namespace softfinger {

/// How nodes map to unknowns: a free node has three of its own; a tied node moves with one rigid
/// body, dx = dc + dtheta x r, whose six unknowns are the two last blocks (or none where the body's
/// motion is prescribed).
struct UnknownMap {
  std::vector<int> block_of_node;  ///< -1: tied
  int free_blocks = 0;
  bool body_moves = true;
  [[nodiscard]] int blocks() const { return free_blocks + (body_moves ? 2 : 0); }
  [[nodiscard]] int translation_block() const { return free_blocks; }
  [[nodiscard]] int rotation_block() const { return free_blocks + 1; }
};

[[nodiscard]] UnknownMap make_unknown_map(const std::vector<bool>& tied, bool body_moves);

/// Assembles the Hessian of an elastic model, and of whatever else acts on its nodes and body, into
/// a block Cholesky factorisation. Immutable but for the factorisation it owns.
class StiffnessAssembly {
 public:
  /// `threads`: of the largest team that will factor or solve.
  StiffnessAssembly(const ElasticModel& model, const UnknownMap& map, InstructionSet set,
                    int threads = 1);

  /// Starts over with a zero matrix. `lever_arms[n]` = r of tied node n in W, m.
  void clear(std::span<const Vector3> lever_arms);
  void add_elastic(const ElasticModel& model, const ElasticModel::Work& work, bool projected);
  /// Adds a 3 x 3 second derivative by the position of one node, free or tied; symmetric.
  void add_node(int node, const Matrix3& block);
  /// Adds a symmetric second derivative by the position of a point that three nodes carry by these
  /// weights. All are free, of one element.
  void add_point(const std::array<int, 3>& nodes, const std::array<double, 3>& weights,
                 const Matrix3& block);
  /// Adds to the body's blocks: by translation twice, translation and rotation (symmetric pair),
  /// and rotation twice.
  void add_body(const Matrix3& translation, const Matrix3& translation_rotation,
                const Matrix3& rotation);
  /// Finishes and factors. False where the matrix is not positive definite.
  [[nodiscard]] bool factor(ThreadTeam* team = nullptr);
  void solve(std::span<double> x, ThreadTeam* team = nullptr) const { cholesky_.solve(x, team); }
  void solve_together(std::span<const std::span<double>> xs, ThreadTeam* team = nullptr) const {
    cholesky_.solve_together(xs, team);
  }
  [[nodiscard]] const BlockCholesky& cholesky() const { return cholesky_; }

 private:
  void add_lane(const BlockCholesky::Slot& slot, const float (&block)[9][kLanes], std::size_t lane);
  void add_patches(const ElasticModel& model, const ElasticModel::Work& work);
  void add_body_rows(const ElementGroup& group, const ElementBodyHessians& rows, std::size_t lane);

  UnknownMap map_;
  BlockCholesky cholesky_;
  std::vector<std::array<BlockCholesky::Slot, 10>> pair_slots_;  ///< per element
  std::vector<BlockCholesky::Slot> diagonal_slots_;              ///< per block
  std::vector<std::array<BlockCholesky::Slot, 2>> body_slots_;   ///< per free block
  std::vector<BlockCholesky::Slot> patch_slots_;  ///< pairs (a, b), a < b, of each patch's nodes
  std::vector<Vector3> patch_gradients_;
  BlockCholesky::Slot body_cross_slot_;
  std::vector<Vector3> lever_arms_;
  Matrix3 body_[3];  ///< translation, translation-rotation, rotation
};

}  // namespace softfinger
