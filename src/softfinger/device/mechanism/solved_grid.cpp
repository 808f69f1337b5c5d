#include "softfinger/device/mechanism/solved_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfinger {
namespace {

constexpr int kMostNodes = 4096;
constexpr int kMostStepsAway = 15;  // from home along one axis
constexpr int kBits = 5;            // of a key, for one axis
static_assert(kMaxLinkageInputs * kBits <= 64 && 2 * kMostStepsAway + 1 < 1 << kBits);

std::uint64_t key_unit(Eigen::Index axis) {
  return std::uint64_t{1} << (kBits * static_cast<int>(axis));
}

int steps_along(std::uint64_t key, Eigen::Index axis) {
  return static_cast<int>(key >> (kBits * static_cast<int>(axis)) & ((1U << kBits) - 1)) -
         kMostStepsAway;
}

}  // namespace

SolvedGrid::SolvedGrid(const ClosedLinkage& linkage, std::vector<LinkageReading> readings,
                       const LinkageSolution& home, LinkageInputs spacing, const Inside& inside)
    : origin_(home.values), spacing_(std::move(spacing)), determinant_(home.determinant) {
  const Eigen::Index axes = origin_.size();
  Key at_home = 0;
  for (Eigen::Index k = 0; k < axes; ++k) at_home += kMostStepsAway * key_unit(k);
  std::vector<Key> keys{at_home};
  add(home, inside(home));
  index_[at_home] = 0;
  LinkageSolution from;
  LinkageSolution next;
  for (std::size_t visited = 0; visited < nodes_.size() && size() < kMostNodes; ++visited) {
    if (!nodes_[visited].inside) continue;
    load(nodes_[visited], from);
    for (Eigen::Index k = 0; k < axes; ++k) {
      for (const int side : {-1, 1}) {
        const int steps = steps_along(keys[visited], k) + side;
        const Key key = side > 0 ? keys[visited] + key_unit(k) : keys[visited] - key_unit(k);
        if (std::abs(steps) > kMostStepsAway || index_.contains(key)) continue;
        LinkageInputs values = origin_;
        for (Eigen::Index i = 0; i < axes; ++i) values[i] += spacing_[i] * steps_along(key, i);
        next = from;
        if (!linkage.follow(readings, values, next)) continue;
        index_[key] = size();
        keys.push_back(key);
        add(next, inside(next));
      }
    }
  }
}

void SolvedGrid::add(const LinkageSolution& solution, bool inside) {
  nodes_.push_back({solution.x, solution.values, by_value_.size(), inside});
  by_value_.insert(by_value_.end(), solution.by_value.data(),
                   solution.by_value.data() + solution.by_value.size());
}

void SolvedGrid::load(const Node& node, LinkageSolution& solution) const {
  solution.x = node.x;
  solution.values = node.values;
  solution.by_value = Eigen::Map<const Eigen::MatrixXd>(by_value_.data() + node.by_value,
                                                        node.x.size(), node.values.size());
  solution.determinant = determinant_;
}

double SolvedGrid::spacings(const LinkageInputs& a, const LinkageInputs& b) const {
  return (a - b).cwiseQuotient(spacing_).cwiseAbs().maxCoeff();
}

const SolvedGrid::Node& SolvedGrid::start(const LinkageInputs& q, bool inside) const {
  const auto pieces = static_cast<int>(std::ceil(std::min(2.0 * spacings(q, origin_), 64.0)));
  for (int piece = 0; piece < pieces; ++piece) {
    const Node* node = near(q + (static_cast<double>(piece) / pieces) * (origin_ - q));
    if (node != nullptr && (node->inside || !inside)) return *node;
  }
  return nodes_.front();
}

const SolvedGrid::Node* SolvedGrid::near(const LinkageInputs& q) const {
  Key key = 0;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const double steps = std::round((q[k] - origin_[k]) / spacing_[k]);
    if (!(std::abs(steps) <= kMostStepsAway)) return nullptr;
    key += key_unit(k) * static_cast<Key>(static_cast<int>(steps) + kMostStepsAway);
  }
  const auto found = index_.find(key);
  return found == index_.end() ? nullptr : &nodes_[static_cast<std::size_t>(found->second)];
}

bool SolvedGrid::surrounded(const LinkageInputs& q) const {
  Key low = 0;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const double steps = std::floor((q[k] - origin_[k]) / spacing_[k]);
    if (!(steps >= -kMostStepsAway && steps < kMostStepsAway)) return false;
    low += key_unit(k) * static_cast<Key>(static_cast<int>(steps) + kMostStepsAway);
  }
  for (unsigned corner = 0; corner < 1U << q.size(); ++corner) {
    Key key = low;
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      if ((corner >> k & 1U) != 0) key += key_unit(k);
    }
    const auto found = index_.find(key);
    if (found == index_.end() || !nodes_[static_cast<std::size_t>(found->second)].inside) {
      return false;
    }
  }
  return true;
}

}  // namespace softfinger
