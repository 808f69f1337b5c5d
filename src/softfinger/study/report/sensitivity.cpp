#include "softfinger/study/report/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "softfinger/study/random.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kLeastDesigns = 32;
constexpr std::size_t kMostShares = 32;
constexpr std::size_t kLeastInShare = 8;
constexpr int kResamplings = 200;

/// The share that each design is in; designs of one value are in one.
std::vector<std::size_t> shares_along(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> different(values);
  std::ranges::sort(different);
  different.erase(std::unique(different.begin(), different.end()), different.end());
  std::vector<std::size_t> share(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (different.size() <= most) {
      share[order[k]] = static_cast<std::size_t>(
          std::ranges::lower_bound(different, values[order[k]]) - different.begin());
    } else {
      share[order[k]] = k * most / order.size();
    }
  }
  return share;
}

/// Of these designs, each as often as it stands there.
double index_of(const std::vector<std::size_t>& designs, const std::vector<double>& y,
                const std::vector<std::size_t>& share) {
  std::vector<double> sums(kMostShares, 0.0);
  std::vector<double> counts(kMostShares, 0.0);
  double mean = 0.0;
  for (const std::size_t i : designs) {
    sums[share[i]] += y[i];
    counts[share[i]] += 1.0;
    mean += y[i];
  }
  const auto count = static_cast<double>(designs.size());
  mean /= count;
  double total = 0.0;
  for (const std::size_t i : designs) total += (y[i] - mean) * (y[i] - mean);
  double between = 0.0;
  double shares = 0.0;
  for (std::size_t s = 0; s < kMostShares; ++s) {
    if (counts[s] == 0.0) continue;
    shares += 1.0;
    const double off = sums[s] / counts[s] - mean;
    between += counts[s] * off * off;
  }
  if (!(total > 0.0) || count <= shares) return 0.0;
  // Means over few designs differ by chance, as within the shares.
  const double chance = (shares - 1.0) * (total - between) / (count - shares);
  return std::clamp((between - chance) / total, 0.0, 1.0);
}

}  // namespace

std::vector<FirstOrderIndex> first_order_indices(const StudyTable& table, std::size_t quantity) {
  std::vector<double> y;
  std::vector<const StudyRow*> rows;
  for (const StudyRow& row : table.rows) {
    if (!row.feasible()) continue;
    rows.push_back(&row);
    y.push_back(row.quantities[quantity]);
  }
  if (rows.size() < kLeastDesigns) return {};
  const std::size_t shares = std::min(kMostShares, rows.size() / kLeastInShare);
  std::vector<FirstOrderIndex> indices;
  for (std::size_t k = 0; k < table.headings.parameters.size(); ++k) {
    std::vector<double> values;
    values.reserve(rows.size());
    for (const StudyRow* row : rows) values.push_back(row->parameters[k]);
    const std::vector<std::size_t> share = shares_along(values, shares);
    std::vector<std::size_t> designs(rows.size());
    std::iota(designs.begin(), designs.end(), std::size_t{0});
    FirstOrderIndex index{.value = index_of(designs, y, share)};
    UnitRandom random(1);  // the same intervals every time
    std::vector<double> resampled;
    for (int r = 0; r < kResamplings; ++r) {
      for (std::size_t& i : designs) i = random.below(rows.size());
      resampled.push_back(index_of(designs, y, share));
    }
    std::ranges::sort(resampled);
    index.low = std::min(index.value, resampled[kResamplings / 40]);
    index.high = std::max(index.value, resampled[kResamplings - 1 - kResamplings / 40]);
    indices.push_back(index);
  }
  return indices;
}

}  // namespace softfinger
