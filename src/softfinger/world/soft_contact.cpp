#include "softfinger/world/soft_contact.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/instruction_set.hpp"
#include "softfinger/contact/surface_patches.hpp"
#include "softfinger/numerics/dense_panel.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

/// A pair counts where its gap is less than it moves and this, m.
constexpr double kReach = 1e-4;
/// Of the ways without the pairs' forces, that balance() may leave.
constexpr double kBalanced = 1e-5;
/// The same, from where on an iteration that does not halve it is the last: what is left is a kink,
/// or rounding.
constexpr double kNearlyBalanced = 1e-3;
constexpr int kIterations = 12;
constexpr int kHalvings = 6;
/// Nodes whose responses are found at once.
constexpr std::size_t kNodesAtOnce = 4;
/// Pivots below this part of the trace are rounding.
constexpr double kLeastPivot = 1e-12;

/// R with R R^T = K, of a matrix without negative eigenvalues.
Matrix3 root_of(Matrix3 K) {
  Matrix3 R = Matrix3::Zero();
  const double least = kLeastPivot * K.trace();
  for (int rank = 0; rank < 3; ++rank) {
    int at = 0;
    const double pivot = K.diagonal().maxCoeff(&at);
    if (!(pivot > least)) break;
    R.col(rank) = K.col(at) / std::sqrt(pivot);
    K -= R.col(rank) * R.col(rank).transpose();
  }
  return R;
}

}  // namespace

void SoftContact::add(FingerSimulation& simulation, int object) {
  Body& body = bodies_.emplace_back();
  body.simulation = &simulation;
  body.object = object;
  if (object >= 0 && compliance_.size() == 0) reserve_pairs();
  if (compliance_.size() == 0) return;  // nothing is soft
  const FingerModel& model = simulation.model();
  const std::size_t touching = object < 0 ? model.sample_nodes.size() : model.mesh.nodes.size();
  const auto most = static_cast<Eigen::Index>(std::min(touching, 4 * kMostPairs));
  body.yielding.slot_of_node.assign(model.mesh.nodes.size(), -1);
  body.yielding.nodes.reserve(static_cast<std::size_t>(most));
  body.yielding.compliance.setZero(3 * most, 3 * most);
  const std::size_t unknowns = simulation.potential().direction().size();
  body.yielding.columns.assign(3 * kNodesAtOnce, std::vector<double>(unknowns, 0.0));
  body.response.assign(unknowns, 0.0);
}

void SoftContact::reserve_pairs() {
  pairs_.reserve(kMostPairs);
  stiffness_.reserve(kMostPairs);
  stiff_.reserve(kMostPairs);
  roots_.reserve(kMostPairs);
  const auto rows = static_cast<Eigen::Index>(3 * kMostPairs);
  compliance_.setZero(rows, rows);
  for (Eigen::VectorXd* vector :
       {&starts_, &ways_, &better_, &trial_, &forces_, &excess_, &rest_}) {
    vector->setZero(rows);
  }
  factor_.assign(9 * kMostPairs * kMostPairs, 0.0F);
  side_.assign(3 * kMostPairs, 0.0F);
}

void SoftContact::forget() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) forget_factor(b);
}

void SoftContact::forget_factor(std::size_t body) {
  Yielding& yielding = bodies_[body].yielding;
  for (const int node : yielding.nodes) {
    yielding.slot_of_node[static_cast<std::size_t>(node)] = -1;
  }
  yielding.nodes.clear();
}

void SoftContact::begin(std::span<const std::uint8_t> taking_part) {
  any_ = false;
  for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].taking_part = taking_part[b] != 0;
  for (const Body& toucher : bodies_) {
    if (!toucher.taking_part) continue;
    for (const Body& soft : bodies_) {
      if (soft.object < 0 || !soft.taking_part || &soft == &toucher) continue;
      any_ = any_ || toucher.simulation->patches(static_cast<std::size_t>(soft.object)).any();
    }
  }
}

void SoftContact::follow(At at) {
  for (const Body& soft : bodies_) {
    if (soft.object < 0 || !soft.taking_part) continue;
    const std::span<const Vector3> nodes = soft.simulation->potential().positions(at);
    for (const Body& toucher : bodies_) {
      if (!toucher.taking_part || &toucher == &soft) continue;
      toucher.simulation->follow_surface(static_cast<std::size_t>(soft.object), nodes);
    }
  }
}

void SoftContact::hand_over() {
  for (const Body& soft : bodies_) {
    if (soft.object < 0 || !soft.taking_part) continue;
    const auto o = static_cast<std::size_t>(soft.object);
    const std::span<Vector3> loads = soft.simulation->potential().loads();
    std::fill(loads.begin(), loads.end(), Vector3::Zero());
    for (const Body& toucher : bodies_) {
      if (!toucher.taking_part || &toucher == &soft) continue;
      const SurfacePatches& patches = toucher.simulation->patches(o);
      if (!patches.any()) continue;
      const ContactPotential& contact = toucher.simulation->potential().contact();
      for (std::size_t i = 0; i < patches.patches().size(); ++i) {
        const Vector3 force = contact.patch_force(i, o);
        if (force.isZero(0.0)) continue;
        const DeformingSurface::Place& place = patches.place(i);
        for (std::size_t k = 0; k < 3; ++k) {
          loads[static_cast<std::size_t>(place.nodes[k])] -= place.weights[k] * force;
        }
      }
    }
  }
}

void SoftContact::add_pairs(std::size_t toucher, std::size_t soft, bool pressing) {
  const FingerSimulation& simulation = *bodies_[toucher].simulation;
  const auto o = static_cast<std::size_t>(bodies_[soft].object);
  const SurfacePatches& patches = simulation.patches(o);
  if (!patches.any()) return;
  const FingerPotential& potential = bodies_[toucher].simulation->potential();
  for (std::size_t i = 0; i < patches.patches().size(); ++i) {
    if (!patches.patches()[i].near || pairs_.size() == kMostPairs) continue;
    const Vector3 force = potential.contact().patch_force(i, o);
    if (force.isZero(0.0) == pressing) continue;
    const DeformingSurface::Place& place = patches.place(i);
    Pair pair{.toucher = toucher, .object = o, .sample = i, .terms = {}};
    pair.terms[0] = {toucher, simulation.model().sample_nodes[i], 1.0};
    for (std::size_t k = 0; k < 3; ++k) {
      pair.terms[k + 1] = {soft, place.nodes[k], -place.weights[k]};
    }
    for (const Term& term : pair.terms) {
      const FingerPotential& of = bodies_[term.body].simulation->potential();
      pair.start += term.weight * of.motion(term.node, of.direction());
    }
    if (!pressing && potential.contact().patch_gap(i, o) > pair.start.norm() + kReach) continue;
    pair.gradient = -force;
    pairs_.push_back(pair);
  }
}

bool SoftContact::find_pairs(ThreadTeam* team) {
  pairs_.clear();
  for (const bool pressing : {true, false}) {
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (a == b || bodies_[b].object < 0) continue;
        if (bodies_[a].taking_part && bodies_[b].taking_part) add_pairs(a, b, pressing);
      }
    }
  }
  if (pairs_.empty()) return false;
  const auto learn_one = [&](std::size_t b, int) { learn(b); };
  if (team != nullptr) {
    team->run(bodies_.size(), learn_one);
  } else {
    for (std::size_t b = 0; b < bodies_.size(); ++b) learn(b);
  }
  build_compliance();
  return true;
}

void SoftContact::learn(std::size_t b) {
  Body& body = bodies_[b];
  Yielding& yielding = body.yielding;
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::array<int, kNodesAtOnce> waiting{};
    std::size_t count = 0;
    bool full = false;
    const auto learn_waiting = [&] {
      learn_nodes(body, {waiting.data(), count});
      count = 0;
    };
    for (const Pair& pair : pairs_) {
      for (const Term& term : pair.terms) {
        int& slot = yielding.slot_of_node[static_cast<std::size_t>(term.node)];
        if (term.body != b || slot >= 0) continue;
        full =
            3 * static_cast<Eigen::Index>(yielding.nodes.size() + 1) > yielding.compliance.rows();
        if (full) break;
        slot = static_cast<int>(yielding.nodes.size());
        yielding.nodes.push_back(term.node);
        waiting[count++] = term.node;
        if (count == kNodesAtOnce) learn_waiting();
      }
      if (full) break;
    }
    if (count > 0) learn_waiting();
    if (!full) return;
    // Those of earlier steps make room.
    forget_factor(b);
  }
}

void SoftContact::learn_nodes(Body& body, std::span<const int> nodes) {
  const FingerPotential& potential = body.simulation->potential();
  Yielding& yielding = body.yielding;
  std::array<std::span<double>, 3 * kNodesAtOnce> columns;
  for (std::size_t c = 0; c < 3 * nodes.size(); ++c) {
    std::vector<double>& column = yielding.columns[c];
    std::fill(column.begin(), column.end(), 0.0);
    potential.add_load(nodes[c / 3], Vector3::Unit(static_cast<Eigen::Index>(c % 3)), column);
    columns[c] = column;
  }
  potential.solve_together({columns.data(), 3 * nodes.size()});
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Eigen::Index j = 3 * yielding.slot_of_node[static_cast<std::size_t>(nodes[n])];
    for (std::size_t k = 0; k < yielding.nodes.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(3 * k);
      Matrix3 block;
      for (std::size_t c = 0; c < 3; ++c) {
        block.col(static_cast<Eigen::Index>(c)) =
            potential.motion(yielding.nodes[k], yielding.columns[3 * n + c]);
      }
      yielding.compliance.block<3, 3>(i, j) = block;
      yielding.compliance.block<3, 3>(j, i) = block.transpose();
    }
  }
}

Vector3 SoftContact::way(std::size_t pair, std::size_t body,
                         std::span<const double> unknowns) const {
  Vector3 sum = Vector3::Zero();
  for (const Term& term : pairs_[pair].terms) {
    if (term.body != body) continue;
    sum += term.weight * bodies_[body].simulation->potential().motion(term.node, unknowns);
  }
  return sum;
}

void SoftContact::build_compliance() {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    for (std::size_t q = 0; q <= p; ++q) {
      Matrix3 block = Matrix3::Zero();
      for (const Term& a : pairs_[p].terms) {
        const Yielding& yielding = bodies_[a.body].yielding;
        const int i = yielding.slot_of_node[static_cast<std::size_t>(a.node)];
        if (i < 0) continue;
        for (const Term& b : pairs_[q].terms) {
          if (b.body != a.body) continue;
          const int j = yielding.slot_of_node[static_cast<std::size_t>(b.node)];
          if (j < 0) continue;
          block += a.weight * b.weight * yielding.compliance.block<3, 3>(3 * i, 3 * j);
        }
      }
      const auto row = static_cast<Eigen::Index>(3 * p);
      const auto column = static_cast<Eigen::Index>(3 * q);
      compliance_.block<3, 3>(row, column) = block;
      compliance_.block<3, 3>(column, row) = block.transpose();
    }
  }
}

Eigen::Ref<Eigen::MatrixXd> SoftContact::compliance() {
  const auto rows = static_cast<Eigen::Index>(3 * pairs_.size());
  return compliance_.topLeftCorner(rows, rows);
}

void SoftContact::look_at(const Eigen::VectorXd& ways) {
  stiffness_.resize(pairs_.size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const Pair& pair = pairs_[p];
    const FingerPotential& potential = bodies_[pair.toucher].simulation->potential();
    const auto row = static_cast<Eigen::Index>(3 * p);
    const ContactPotential::Response response = potential.contact().respond_to_patch(
        pair.sample, pair.object,
        potential.contact_positions()[pair.sample] + Vector3(ways.segment<3>(row)));
    forces_.segment<3>(row) = response.gradient - pair.gradient;
    stiffness_[p] = response.hessian;
  }
}

double SoftContact::evaluate(const Eigen::VectorXd& ways, bool refined) {
  const auto rows = static_cast<Eigen::Index>(3 * pairs_.size());
  if (refined) {
    look_at(ways);
  } else {
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const auto row = static_cast<Eigen::Index>(3 * p);
      forces_.segment<3>(row) = stiffness_[p] * ways.segment<3>(row);
    }
  }
  excess_.head(rows).noalias() = compliance() * forces_.head(rows);
  excess_.head(rows) += ways.head(rows) - starts_.head(rows);
  return excess_.head(rows).norm();
}

void SoftContact::solve(const Eigen::VectorXd& ways, Eigen::VectorXd& better) {
  const auto rows = static_cast<Eigen::Index>(3 * pairs_.size());
  stiff_.clear();
  roots_.clear();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (stiffness_[p].isZero(0.0)) continue;
    stiff_.push_back(p);
    roots_.push_back(root_of(stiffness_[p]));
  }
  // (1 + W K)^-1 F = F - W R z with K = R R^T and (1 + R^T W R) z = R^T F, in single precision:
  // what that leaves is found anew in double.
  better.head(rows) = ways.head(rows) - excess_.head(rows);
  const auto size = static_cast<int>(3 * stiff_.size());
  const int stride = (size + kPanelAlignment - 1) / kPanelAlignment * kPanelAlignment;
  for (std::size_t b = 0; b < stiff_.size(); ++b) {
    const auto column = static_cast<Eigen::Index>(3 * stiff_[b]);
    for (std::size_t a = b; a < stiff_.size(); ++a) {
      const auto row = static_cast<Eigen::Index>(3 * stiff_[a]);
      Matrix3 block = roots_[a].transpose() * (compliance_.block<3, 3>(row, column) * roots_[b]);
      if (a == b) block.diagonal().array() += 1.0;
      float* const at = factor_.data() + 3 * b * static_cast<std::size_t>(stride) + 3 * a;
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) at[c * stride + r] = static_cast<float>(block(r, c));
      }
    }
    const Vector3 side = roots_[b].transpose() * excess_.segment<3>(column);
    for (int r = 0; r < 3; ++r)
      side_[3 * b + static_cast<std::size_t>(r)] = static_cast<float>(side[r]);
  }
  const DensePanelKernels& kernels = dense_panel_kernels(active_instruction_set());
  if (!kernels.factor(factor_.data(), size, size, stride)) return;
  kernels.solve_forward(factor_.data(), size, size, stride, side_.data(), 0);
  kernels.solve_backward(factor_.data(), size, size, stride, side_.data(), 0);
  rest_.head(rows).setZero();
  for (std::size_t a = 0; a < stiff_.size(); ++a) {
    const Vector3 z(side_[3 * a], side_[3 * a + 1], side_[3 * a + 2]);
    rest_.segment<3>(static_cast<Eigen::Index>(3 * stiff_[a])) = roots_[a] * z;
  }
  better.head(rows).noalias() += compliance() * rest_.head(rows);
}

std::span<const double> SoftContact::balance(bool refined) {
  const auto rows = static_cast<Eigen::Index>(3 * pairs_.size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    starts_.segment<3>(static_cast<Eigen::Index>(3 * p)) = pairs_[p].start;
  }
  ways_.head(rows).setZero();
  look_at(ways_);
  double excess = evaluate(ways_, refined);
  const double enough = kBalanced * excess;
  const double nearly = kNearlyBalanced * excess;
  for (int iteration = 0; iteration < kIterations && excess > enough; ++iteration) {
    solve(ways_, better_);
    const double before = excess;
    double t = 1.0;
    // The shortest step is taken in any case: kinks are passed rather than stopped at.
    for (int halving = 0; halving <= kHalvings; ++halving, t *= 0.5) {
      trial_.head(rows) = ways_.head(rows) + t * (better_.head(rows) - ways_.head(rows));
      excess = evaluate(trial_, refined);
      if (excess < before) break;
    }
    ways_.swap(trial_);
    if (excess < nearly && excess > 0.5 * before) break;
  }
  return {forces_.data(), static_cast<std::size_t>(rows)};
}

void SoftContact::apply(std::size_t b) {
  Body& body = bodies_[b];
  FingerPotential& potential = body.simulation->potential();
  bool any = false;
  std::fill(body.response.begin(), body.response.end(), 0.0);
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    for (const Term& term : pairs_[p].terms) {
      if (term.body != b) continue;
      any = true;
      const Vector3 force = forces_.segment<3>(static_cast<Eigen::Index>(3 * p));
      potential.add_load(term.node, term.weight * force, body.response);
    }
  }
  if (!any) return;
  potential.solve(body.response);
  potential.step_back(body.response);
}

}  // namespace softfinger
