#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "softfinger/device/mechanism/closed_linkage.hpp"

namespace softfinger {

/// Solutions of a linkage on a grid of configurations through home: starts for Newton's method near
/// every configuration, all on the branch of home. Filled from home outwards, neighbour by
/// neighbour, as far as `inside` holds and one node further, up to a number of nodes. Immutable
/// once built; queries do not allocate.
class SolvedGrid {
 public:
  using Inside = std::function<bool(const LinkageSolution& solution)>;
  /// `spacing`: of the nodes, one an axis.
  SolvedGrid(const ClosedLinkage& linkage, std::vector<LinkageReading> readings,
             const LinkageSolution& home, LinkageInputs spacing, const Inside& inside);

  struct Node {
    LinkageCoordinates x;
    LinkageInputs values;
    std::size_t by_value;  ///< where its rates are kept
    bool inside;           ///< and so connected with home
  };
  /// The first node on the way from q to home; home's own if there is none before. `inside`: the
  /// first that is inside.
  [[nodiscard]] const Node& start(const LinkageInputs& q, bool inside) const;
  /// The solution there, but for placement and factors.
  void load(const Node& node, LinkageSolution& solution) const;
  /// Whether all nodes around q are inside.
  [[nodiscard]] bool surrounded(const LinkageInputs& q) const;
  /// How many spacings lie between two configurations, along the axis where it is most.
  [[nodiscard]] double spacings(const LinkageInputs& a, const LinkageInputs& b) const;

  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  /// Nearest to home first.
  [[nodiscard]] const Node& node(int k) const { return nodes_[static_cast<std::size_t>(k)]; }

 private:
  /// Steps from home along each axis, in one number.
  using Key = std::uint64_t;

  void add(const LinkageSolution& solution, bool inside);
  [[nodiscard]] const Node* near(const LinkageInputs& q) const;

  LinkageInputs origin_, spacing_;
  double determinant_;  ///< of home: all have its sign
  std::vector<Node> nodes_;
  std::vector<double> by_value_;
  std::unordered_map<Key, int> index_;
};

}  // namespace softfinger
