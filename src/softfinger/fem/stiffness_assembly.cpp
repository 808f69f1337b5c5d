#include "softfinger/fem/stiffness_assembly.hpp"

#include <algorithm>

namespace softfinger {
namespace {

/// Node pairs (a, b) in the order of ElementHessians.
constexpr std::array<std::array<std::size_t, 2>, 10> kPairs{
    {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}}};

template <typename Visit>
void for_each_pair(const ElasticModel& model, Visit&& visit) {
  for (std::size_t e = 0; e < model.elements(); ++e) {
    const ElementGroup& group = model.groups()[e / kLaneCount];
    for (std::size_t k = 0; k < kPairs.size(); ++k) {
      visit(e, k, group.nodes[kPairs[k][0]][e % kLaneCount],
            group.nodes[kPairs[k][1]][e % kLaneCount]);
    }
  }
}

/// Calls visit(a, b) for every two nodes that an element or a patch ties together, a != b.
template <typename Visit>
void for_each_coupling(const ElasticModel& model, Visit&& visit) {
  for_each_pair(model, [&](std::size_t, std::size_t, int a, int b) {
    if (a != b) visit(a, b);
  });
  for (const ElasticModel::Patch& patch : model.patches()) {
    for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
      for (std::size_t b = a + 1; b < patch.nodes.size(); ++b)
        visit(patch.nodes[a], patch.nodes[b]);
    }
  }
}

struct Pattern {
  std::vector<std::pair<int, int>> pairs;
  std::vector<bool> touches_body;  ///< per free block
};

Pattern pattern_of(const ElasticModel& model, const UnknownMap& map) {
  Pattern pattern;
  pattern.touches_body.assign(static_cast<std::size_t>(map.free_blocks), false);
  for_each_coupling(model, [&](int a, int b) {
    const int i = map.block_of_node[static_cast<std::size_t>(a)];
    const int j = map.block_of_node[static_cast<std::size_t>(b)];
    if (i >= 0 && j >= 0) pattern.pairs.emplace_back(i, j);
    if (i >= 0 && j < 0) pattern.touches_body[static_cast<std::size_t>(i)] = true;
    if (j >= 0 && i < 0) pattern.touches_body[static_cast<std::size_t>(j)] = true;
  });
  if (map.body_moves) {
    pattern.pairs.emplace_back(map.translation_block(), map.rotation_block());
    for (int i = 0; i < map.free_blocks; ++i) {
      if (!pattern.touches_body[static_cast<std::size_t>(i)]) continue;
      pattern.pairs.emplace_back(i, map.translation_block());
      pattern.pairs.emplace_back(i, map.rotation_block());
    }
  }
  return pattern;
}

}  // namespace

UnknownMap make_unknown_map(const std::vector<bool>& tied, bool body_moves) {
  UnknownMap map;
  map.body_moves = body_moves;
  for (const bool is_tied : tied) map.block_of_node.push_back(is_tied ? -1 : map.free_blocks++);
  return map;
}

StiffnessAssembly::StiffnessAssembly(const ElasticModel& model, const UnknownMap& map,
                                     InstructionSet set, int threads)
    : map_(map), lever_arms_(map.block_of_node.size(), Vector3::Zero()) {
  const Pattern pattern = pattern_of(model, map);
  cholesky_ = BlockCholesky(map.blocks(), pattern.pairs, set, threads);
  pair_slots_.resize(model.elements());
  const auto slot_of = [&](int a, int b) {
    const int i = map.block_of_node[static_cast<std::size_t>(a)];
    const int j = map.block_of_node[static_cast<std::size_t>(b)];
    return i >= 0 && j >= 0 ? cholesky_.slot(i, j) : BlockCholesky::Slot{};
  };
  for_each_pair(model, [&](std::size_t e, std::size_t k, int a, int b) {
    pair_slots_[e][k] = slot_of(a, b);
  });
  std::size_t patch_nodes = 0;
  for (const ElasticModel::Patch& patch : model.patches()) {
    patch_nodes += patch.nodes.size();
    for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
      for (std::size_t b = a + 1; b < patch.nodes.size(); ++b) {
        patch_slots_.push_back(slot_of(patch.nodes[a], patch.nodes[b]));
      }
    }
  }
  patch_gradients_.assign(patch_nodes, Vector3::Zero());
  body_slots_.resize(static_cast<std::size_t>(map.free_blocks));
  for (int i = 0; i < map.free_blocks && map.body_moves; ++i) {
    if (!pattern.touches_body[static_cast<std::size_t>(i)]) continue;
    body_slots_[static_cast<std::size_t>(i)] = {cholesky_.slot(i, map.translation_block()),
                                                cholesky_.slot(i, map.rotation_block())};
  }
  for (int i = 0; i < map.blocks(); ++i) diagonal_slots_.push_back(cholesky_.slot(i, i));
  if (map.body_moves) {
    body_cross_slot_ = cholesky_.slot(map.translation_block(), map.rotation_block());
  }
}

void StiffnessAssembly::clear(std::span<const Vector3> lever_arms) {
  cholesky_.clear();
  std::copy(lever_arms.begin(), lever_arms.end(), lever_arms_.begin());
  for (Matrix3& block : body_) block.setZero();
}

void StiffnessAssembly::add_elastic(const ElasticModel& model, const ElasticModel::Work& work,
                                    bool projected) {
  ElementHessians hessians;
  ElementBodyHessians body_rows;
  BodyHessianSums body_sums{};
  for (std::size_t g = 0; g < model.groups().size(); ++g) {
    model.hessian(g, work, projected, hessians);
    const bool with_body = map_.body_moves && model.touches_body(g);
    if (with_body) model.body_hessian(g, lever_arms_, hessians, body_rows, body_sums);
    const std::size_t lanes = std::min(kLaneCount, model.elements() - g * kLaneCount);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto& slots = pair_slots_[g * kLaneCount + lane];
      for (std::size_t k = 0; k < kPairs.size(); ++k) {
        if (slots[k].row != 0) add_lane(slots[k], hessians.block[k], lane);
      }
      if (with_body) add_body_rows(model.groups()[g], body_rows, lane);
    }
  }
  add_patches(model, work);
  if (!map_.body_moves) return;
  for (int e = 0; e < 9; ++e) {
    const auto sum = [e](const float(&terms)[9][kLanes]) {
      double total = 0.0;
      for (const float term : terms[e]) total += static_cast<double>(term);
      return total;
    };
    body_[0].data()[e] += sum(body_sums.translation);
    body_[1].data()[e] += sum(body_sums.translation_rotation);
    body_[2].data()[e] += sum(body_sums.rotation);
  }
}

void StiffnessAssembly::add_patches(const ElasticModel& model, const ElasticModel::Work& work) {
  if (model.patches().empty()) return;
  model.patch_gradients(work, patch_gradients_);
  const Vector3* gradients = patch_gradients_.data();
  const BlockCholesky::Slot* slot = patch_slots_.data();
  for (const ElasticModel::Patch& patch : model.patches()) {
    // Second derivative lambda / V g g^T; the body's rows of g are sums over its nodes.
    const double stiffness = work.factor * patch.lambda / patch.volume;
    Vector3 body = Vector3::Zero();
    Vector3 body_turn = Vector3::Zero();
    const auto block_at = [&](std::size_t a) {
      return map_.block_of_node[static_cast<std::size_t>(patch.nodes[a])];
    };
    for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
      if (block_at(a) >= 0) continue;
      body += gradients[a];
      body_turn += lever_arms_[static_cast<std::size_t>(patch.nodes[a])].cross(gradients[a]);
    }
    for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
      const int i = block_at(a);
      const Vector3 scaled = stiffness * gradients[a];
      if (i >= 0) {
        const Matrix3 own = scaled * gradients[a].transpose();
        cholesky_.add(diagonal_slots_[static_cast<std::size_t>(i)], own.data());
        const auto& slots = body_slots_[static_cast<std::size_t>(i)];
        if (slots[0].row != 0) {
          const Matrix3 by_translation = scaled * body.transpose();
          const Matrix3 by_rotation = scaled * body_turn.transpose();
          cholesky_.add(slots[0], by_translation.data());
          cholesky_.add(slots[1], by_rotation.data());
        }
      }
      for (std::size_t b = a + 1; b < patch.nodes.size(); ++b, ++slot) {
        if (slot->row == 0) continue;
        const Matrix3 block = scaled * gradients[b].transpose();
        cholesky_.add(*slot, block.data());
      }
    }
    body_[0] += stiffness * body * body.transpose();
    body_[1] += stiffness * body * body_turn.transpose();
    body_[2] += stiffness * body_turn * body_turn.transpose();
    gradients += patch.nodes.size();
  }
}

void StiffnessAssembly::add_lane(const BlockCholesky::Slot& slot, const float (&block)[9][kLanes],
                                 std::size_t lane) {
  float* v = cholesky_.values() + slot.offset;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) v[r * slot.row + c * slot.column] += block[3 * c + r][lane];
  }
}

void StiffnessAssembly::add_body_rows(const ElementGroup& group, const ElementBodyHessians& rows,
                                      std::size_t lane) {
  for (std::size_t a = 0; a < 4; ++a) {
    const int i = map_.block_of_node[static_cast<std::size_t>(group.nodes[a][lane])];
    if (i < 0) continue;
    const auto& slots = body_slots_[static_cast<std::size_t>(i)];
    if (slots[0].row == 0) continue;  // no neighbour of the node moves with the body
    add_lane(slots[0], rows.by_translation[a], lane);
    add_lane(slots[1], rows.by_rotation[a], lane);
  }
}

void StiffnessAssembly::add_node(int node, const Matrix3& block) {
  const int i = map_.block_of_node[static_cast<std::size_t>(node)];
  if (i >= 0) {
    cholesky_.add(diagonal_slots_[static_cast<std::size_t>(i)], block.data());
    return;
  }
  if (!map_.body_moves) return;
  const Matrix3 arm = skew(lever_arms_[static_cast<std::size_t>(node)]);
  body_[0] += block;
  body_[1] -= block * arm;
  body_[2] -= arm * block * arm;
}

void StiffnessAssembly::add_point(const std::array<int, 3>& nodes,
                                  const std::array<double, 3>& weights, const Matrix3& block) {
  for (std::size_t a = 0; a < 3; ++a) {
    const int i = map_.block_of_node[static_cast<std::size_t>(nodes[a])];
    for (std::size_t b = a; b < 3; ++b) {
      const int j = map_.block_of_node[static_cast<std::size_t>(nodes[b])];
      const Matrix3 part = weights[a] * weights[b] * block;
      cholesky_.add(cholesky_.slot(i, j), part.data());
    }
  }
}

void StiffnessAssembly::add_body(const Matrix3& translation, const Matrix3& translation_rotation,
                                 const Matrix3& rotation) {
  body_[0] += translation;
  body_[1] += translation_rotation;
  body_[2] += rotation;
}

bool StiffnessAssembly::factor(ThreadTeam* team) {
  if (map_.body_moves) {
    cholesky_.add(diagonal_slots_[static_cast<std::size_t>(map_.translation_block())],
                  body_[0].data());
    cholesky_.add(body_cross_slot_, body_[1].data());
    cholesky_.add(diagonal_slots_[static_cast<std::size_t>(map_.rotation_block())],
                  body_[2].data());
  }
  return cholesky_.factor(team);
}

}  // namespace softfinger
