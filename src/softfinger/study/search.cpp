#include "softfinger/study/search.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "softfinger/base/error.hpp"
#include "softfinger/study/loaded_module.hpp"
#include "softfinger/study/pagmo/gene_search.hpp"

namespace softfinger {
namespace {

/// Free parameters as genes: logarithms where they vary by factors, numbers of values, which come
/// last.
class Genes {
 public:
  explicit Genes(const Study& study) {
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
  void bound(GeneSearch& search) const {
    search.whole = order_.size() - continuous_;
    for (const std::size_t k : order_) {
      const Parameter& parameter = *free_[k];
      const bool log = parameter.log;
      search.least.push_back(parameter.is_discrete() ? 0.0
                             : log                   ? std::log(parameter.min)
                                                     : parameter.min);
      search.most.push_back(parameter.is_discrete()
                                ? static_cast<double>(parameter.values.size() - 1)
                            : log ? std::log(parameter.max)
                                  : parameter.max);
    }
  }
  [[nodiscard]] std::size_t count() const { return order_.size(); }
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

}  // namespace

bool can_search() { return !module_file(kPagmoModule).empty(); }

void search(const Study& study, const BatchFitness& fitness) {
  const std::filesystem::path file = module_file(kPagmoModule);
  if (file.empty()) {
    throw OperationError(
        "this program was built without pagmo, which searches; use grid, lhs or "
        "sobol, or build it where libpagmo-dev is installed");
  }
  void* const search_genes = module_function(file, kSearchGenes);
  if (search_genes == nullptr) {
    throw OperationError(file.string() + ": cannot be loaded; is pagmo's library here?");
  }
  const DesignPlan& plan = study.plan;
  const Genes genes_of_study(study);
  GeneSearch search{.objectives = study.objectives.size(),
                    .of_a_front = plan.kind == DesignKind::kNsga2,
                    .size = static_cast<unsigned>(plan.size),
                    .generations = static_cast<unsigned>(plan.generations),
                    .seed = static_cast<unsigned>(plan.seed)};
  genes_of_study.bound(search);
  search.fitness = [&](const std::vector<double>& genes) {
    std::vector<std::vector<double>> designs;
    for (std::size_t at = 0; at + genes_of_study.count() <= genes.size();
         at += genes_of_study.count()) {
      designs.push_back(genes_of_study.chosen(genes.data() + at));
    }
    std::vector<double> result;
    for (const std::vector<double>& one : fitness(designs)) {
      result.insert(result.end(), one.begin(), one.end());
    }
    return result;
  };
  reinterpret_cast<SearchGenes>(search_genes)(search);
}

}  // namespace softfinger
