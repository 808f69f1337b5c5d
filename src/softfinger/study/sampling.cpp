#include "softfinger/study/sampling.hpp"

#include <boost/random/sobol.hpp>
#include <numeric>
#include <utility>

#include "softfinger/study/random.hpp"

namespace softfinger {
namespace {

using Points = std::vector<std::vector<double>>;

std::vector<const Parameter*> free_parameters(const Study& study) {
  std::vector<const Parameter*> free;
  for (const Parameter& parameter : study.parameters) {
    if (parameter.is_free()) free.push_back(&parameter);
  }
  return free;
}

Points grid(const std::vector<const Parameter*>& free, std::size_t size) {
  Points points;
  std::vector<std::size_t> at(free.size(), 0);
  while (points.size() < size) {
    std::vector<double>& point = points.emplace_back();
    for (std::size_t k = 0; k < free.size(); ++k) point.push_back(free[k]->values[at[k]]);
    for (std::size_t k = free.size(); k-- > 0;) {
      if (++at[k] < free[k]->values.size()) break;
      at[k] = 0;
    }
  }
  return points;
}

Points latin_hypercube(const std::vector<const Parameter*>& free, std::size_t size,
                       std::uint64_t seed) {
  UnitRandom random(seed);
  Points points(size, std::vector<double>(free.size()));
  std::vector<std::size_t> parts(size);
  for (std::size_t k = 0; k < free.size(); ++k) {
    std::iota(parts.begin(), parts.end(), std::size_t{0});
    for (std::size_t i = size; i > 1; --i) std::swap(parts[i - 1], parts[random.below(i)]);
    for (std::size_t i = 0; i < size; ++i) {
      const double u = (static_cast<double>(parts[i]) + random.next()) / static_cast<double>(size);
      points[i][k] = free[k]->at(u);
    }
  }
  return points;
}

Points sobol(const std::vector<const Parameter*>& free, std::size_t size, std::uint64_t seed) {
  boost::random::sobol sequence(free.size());
  UnitRandom random(seed);
  std::vector<std::uint64_t> shift(free.size());
  for (std::uint64_t& bits : shift) bits = random.bits();
  Points points(size, std::vector<double>(free.size()));
  for (std::vector<double>& point : points) {
    for (std::size_t k = 0; k < free.size(); ++k) {
      const std::uint64_t bits = sequence() ^ shift[k];
      point[k] = free[k]->at(static_cast<double>(bits >> 11) * 0x1.0p-53);
    }
  }
  return points;
}

}  // namespace

Points sampled_designs(const Study& study) {
  const std::vector<const Parameter*> free = free_parameters(study);
  const DesignPlan& plan = study.plan;
  if (plan.kind == DesignKind::kLhs) return latin_hypercube(free, plan.size, plan.seed);
  if (plan.kind == DesignKind::kSobol) return sobol(free, plan.size, plan.seed);
  return grid(free, plan.size);
}

}  // namespace softfinger
