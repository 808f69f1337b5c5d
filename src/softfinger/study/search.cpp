#include "softfinger/study/search.hpp"

#include <cmath>

#include "softfinger/base/error.hpp"

#ifdef SOFTFINGER_PAGMO
#include <algorithm>
#include <exception>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>
#endif

namespace softfinger {

#ifdef SOFTFINGER_PAGMO
namespace {

/// What pagmo knows of a study: box bounds, numbers of values last, as it wants whole numbers.
class Chromosomes {
 public:
  explicit Chromosomes(const Study& study) {
    for (const Parameter& parameter : study.parameters) {
      if (parameter.is_free()) free_.push_back(&parameter);
    }
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (!free_[k]->is_discrete()) order_.push_back(k);
    }
    continuous_ = order_.size();
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (free_[k]->is_discrete()) order_.push_back(k);
    }
  }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> bounds() const {
    std::vector<double> low;
    std::vector<double> high;
    for (const std::size_t k : order_) {
      const Parameter& parameter = *free_[k];
      const bool log = parameter.log;
      low.push_back(parameter.is_discrete() ? 0.0 : log ? std::log(parameter.min) : parameter.min);
      high.push_back(parameter.is_discrete() ? static_cast<double>(parameter.values.size() - 1)
                     : log                   ? std::log(parameter.max)
                                             : parameter.max);
    }
    return {low, high};
  }
  [[nodiscard]] std::size_t whole() const { return order_.size() - continuous_; }
  [[nodiscard]] std::vector<double> chosen(const double* genes) const {
    std::vector<double> chosen(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Parameter& parameter = *free_[order_[i]];
      double& value = chosen[order_[i]];
      if (parameter.is_discrete()) {
        value = parameter.values[static_cast<std::size_t>(genes[i])];
      } else {
        value =
            std::clamp(parameter.log ? std::exp(genes[i]) : genes[i], parameter.min, parameter.max);
      }
    }
    return chosen;
  }

 private:
  std::vector<const Parameter*> free_;
  std::vector<std::size_t> order_;
  std::size_t continuous_ = 0;
};

struct StudyProblem {
  std::pair<std::vector<double>, std::vector<double>> bounds;
  std::size_t whole = 0, objectives = 1;

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>&) const {
    throw OperationError("study: a design was evaluated alone");  // batches alone
  }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return bounds;
  }
  [[nodiscard]] std::size_t get_nix() const { return whole; }
  [[nodiscard]] std::size_t get_nobj() const { return objectives; }
};

/// Ours, in the place of pagmo's own threads.
struct StudyBatch {
  const Chromosomes* chromosomes = nullptr;
  const BatchFitness* batch = nullptr;

  std::vector<double> operator()(const pagmo::problem& problem,
                                 const std::vector<double>& genes) const {
    const std::size_t size = problem.get_nx();
    std::vector<std::vector<double>> designs;
    for (std::size_t at = 0; at + size <= genes.size(); at += size) {
      designs.push_back(chromosomes->chosen(genes.data() + at));
    }
    std::vector<double> result;
    for (const std::vector<double>& one : (*batch)(designs)) {
      result.insert(result.end(), one.begin(), one.end());
    }
    return result;
  }
};

}  // namespace

bool can_search() { return true; }

void search(const Study& study, const BatchFitness& fitness) {
  const Chromosomes chromosomes(study);
  const pagmo::problem problem(StudyProblem{.bounds = chromosomes.bounds(),
                                            .whole = chromosomes.whole(),
                                            .objectives = study.objectives.size()});
  const pagmo::bfe batch(StudyBatch{&chromosomes, &fitness});
  const DesignPlan& plan = study.plan;
  pagmo::population population(problem, batch, plan.size, plan.seed);
  const auto generations = static_cast<unsigned>(plan.generations);
  if (plan.kind == DesignKind::kNsga2) {
    pagmo::nsga2 algorithm(generations, 0.95, 10.0, 1.0 / static_cast<double>(problem.get_nx()),
                           50.0, plan.seed);
    algorithm.set_bfe(batch);
    static_cast<void>(algorithm.evolve(std::move(population)));
  } else {
    const auto kernel = static_cast<unsigned>(std::min<std::size_t>(63, plan.size));
    pagmo::gaco algorithm(generations, kernel, 1.0, 0.0, 0.01, 1, 7, 100000, 100000, 0.0, false,
                          plan.seed);
    algorithm.set_bfe(batch);
    static_cast<void>(algorithm.evolve(std::move(population)));
  }
}

#else

bool can_search() { return false; }

void search(const Study&, const BatchFitness&) {
  throw OperationError(
      "this program was built without pagmo, which searches; use grid, lhs or "
      "sobol, or build it where libpagmo-dev is installed");
}

#endif

}  // namespace softfinger
