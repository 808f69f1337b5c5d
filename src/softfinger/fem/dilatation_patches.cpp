#include "softfinger/fem/dilatation_patches.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace softfinger {
namespace {

constexpr int kPatchSize = 4;

/// Up to four neighbours across faces, of the same material, the last first; -1: none.
using Neighbours = std::vector<std::array<int, 4>>;

Neighbours neighbours_of(std::span<const Tetrahedron> tetrahedra, std::span<const int> material) {
  Neighbours neighbours(tetrahedra.size(), {-1, -1, -1, -1});
  const auto add = [&](int to, int neighbour) {
    auto& list = neighbours[static_cast<std::size_t>(to)];
    *std::find(list.begin(), list.end(), -1) = neighbour;
  };
  const std::vector<TetrahedronFace> faces = faces_of(tetrahedra);
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].sorted != faces[f - 1].sorted) continue;
    const int a = faces[f - 1].tetrahedron;
    const int b = faces[f].tetrahedron;
    const int of_a = material[static_cast<std::size_t>(a)];
    if (of_a < 0 || of_a != material[static_cast<std::size_t>(b)]) continue;
    add(a, b);
    add(b, a);
  }
  for (auto& list : neighbours) std::sort(list.begin(), list.end(), std::greater<>());
  return neighbours;
}

/// Four times the centre, the same bits in whichever order the corners are listed.
Vector3 centre_of(const Tetrahedron& tetrahedron, std::span<const Vector3> nodes) {
  Vector3 centre = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::array<double, 4> at{};
    for (std::size_t k = 0; k < 4; ++k)
      at[k] = nodes[static_cast<std::size_t>(tetrahedron[k])][axis];
    std::sort(at.begin(), at.end());
    centre[axis] = std::accumulate(at.begin(), at.end(), 0.0);
  }
  return centre;
}

/// Tetrahedra by where they are, so that how a mesh numbers them does not matter.
std::vector<int> order_by_place(std::span<const Tetrahedron> tetrahedra,
                                std::span<const Vector3> nodes) {
  std::vector<Vector3> centres;
  for (const Tetrahedron& tetrahedron : tetrahedra) {
    centres.push_back(centre_of(tetrahedron, nodes));
  }
  std::vector<int> order(tetrahedra.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Vector3& at_a = centres[static_cast<std::size_t>(a)];
    const Vector3& at_b = centres[static_cast<std::size_t>(b)];
    return std::lexicographical_compare(at_a.begin(), at_a.end(), at_b.begin(), at_b.end());
  });
  return order;
}

class PatchGrowth {
 public:
  PatchGrowth(std::span<const Tetrahedron> tetrahedra, const Neighbours& neighbours,
              std::vector<int>& patch)
      : tetrahedra_(tetrahedra), neighbours_(neighbours), patch_(patch) {}

  void grow(int seed, int number) {
    members_.assign(1, seed);
    patch_[static_cast<std::size_t>(seed)] = number;
    while (members_.size() < kPatchSize) {
      const int next = closest_neighbour();
      if (next < 0) return;
      patch_[static_cast<std::size_t>(next)] = number;
      members_.push_back(next);
    }
  }
  [[nodiscard]] int free_neighbours(int t) const {
    int count = 0;
    for (const int n : neighbours_[static_cast<std::size_t>(t)]) count += is_free(n) ? 1 : 0;
    return count;
  }

 private:
  [[nodiscard]] bool is_free(int t) const {
    return t >= 0 && patch_[static_cast<std::size_t>(t)] == kUnassigned;
  }
  /// The free neighbour that shares most nodes with the members, so that patches are compact; of
  /// equals the one with fewest free neighbours left, so that none is left over.
  [[nodiscard]] int closest_neighbour() const {
    int best = -1;
    int best_score = -1;
    for (const int member : members_) {
      for (const int candidate : neighbours_[static_cast<std::size_t>(member)]) {
        if (!is_free(candidate)) continue;
        const int score = 8 * shared_nodes(candidate) + 4 - free_neighbours(candidate);
        if (score > best_score || (score == best_score && candidate < best)) {
          best = candidate;
          best_score = score;
        }
      }
    }
    return best;
  }
  [[nodiscard]] int shared_nodes(int candidate) const {
    int shared = 0;
    for (const int node : tetrahedra_[static_cast<std::size_t>(candidate)]) {
      for (const int member : members_) {
        const Tetrahedron& t = tetrahedra_[static_cast<std::size_t>(member)];
        shared += static_cast<int>(std::count(t.begin(), t.end(), node));
      }
    }
    return shared;
  }

 public:
  static constexpr int kUnassigned = -2;

 private:
  std::span<const Tetrahedron> tetrahedra_;
  const Neighbours& neighbours_;
  std::vector<int>& patch_;
  std::vector<int> members_;
};

/// Lone tetrahedra lock as before: each joins the smallest patch beside it.
void join_lone(const Neighbours& neighbours, std::vector<int>& patch, int count) {
  std::vector<int> sizes(static_cast<std::size_t>(count), 0);
  for (const int p : patch) {
    if (p >= 0) ++sizes[static_cast<std::size_t>(p)];
  }
  for (std::size_t t = 0; t < patch.size(); ++t) {
    if (patch[t] < 0 || sizes[static_cast<std::size_t>(patch[t])] > 1) continue;
    int smallest = -1;
    for (const int n : neighbours[t]) {
      if (n < 0) continue;
      const int p = patch[static_cast<std::size_t>(n)];
      if (smallest < 0 ||
          sizes[static_cast<std::size_t>(p)] < sizes[static_cast<std::size_t>(smallest)]) {
        smallest = p;
      }
    }
    if (smallest < 0) continue;
    --sizes[static_cast<std::size_t>(patch[t])];
    ++sizes[static_cast<std::size_t>(smallest)];
    patch[t] = smallest;
  }
}

std::vector<int> patches_in_order(std::span<const Tetrahedron> tetrahedra,
                                  std::span<const int> material) {
  const Neighbours neighbours = neighbours_of(tetrahedra, material);
  std::vector<int> patch(tetrahedra.size(), PatchGrowth::kUnassigned);
  for (std::size_t t = 0; t < patch.size(); ++t) {
    if (material[t] < 0) patch[t] = -1;
  }
  PatchGrowth growth(tetrahedra, neighbours, patch);
  int count = 0;
  // Those with fewest ways to go begin: corners first, so that few are left over.
  for (int ways = 0; ways <= 4; ++ways) {
    bool again = true;
    while (again) {
      again = false;
      for (std::size_t t = 0; t < patch.size(); ++t) {
        if (patch[t] != PatchGrowth::kUnassigned) continue;
        if (growth.free_neighbours(static_cast<int>(t)) > ways) continue;
        growth.grow(static_cast<int>(t), count++);
        again = ways > 0;
      }
    }
  }
  join_lone(neighbours, patch, count);
  std::vector<int> number(static_cast<std::size_t>(count), -1);
  int used = 0;
  for (int& p : patch) {
    if (p < 0) continue;
    int& n = number[static_cast<std::size_t>(p)];
    if (n < 0) n = used++;
    p = n;
  }
  return patch;
}

}  // namespace

std::vector<int> dilatation_patches(std::span<const Vector3> nodes,
                                    std::span<const Tetrahedron> tetrahedra,
                                    std::span<const int> material) {
  const std::vector<int> order = order_by_place(tetrahedra, nodes);
  std::vector<Tetrahedron> placed;
  std::vector<int> placed_material;
  for (const int t : order) {
    placed.push_back(tetrahedra[static_cast<std::size_t>(t)]);
    placed_material.push_back(material[static_cast<std::size_t>(t)]);
  }
  const std::vector<int> placed_patch = patches_in_order(placed, placed_material);
  std::vector<int> patch(tetrahedra.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    patch[static_cast<std::size_t>(order[k])] = placed_patch[k];
  }
  return patch;
}

}  // namespace softfinger
