// What links pagmo, whose data alone take a program a tenth of a second to start with.
#include <algorithm>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>
#include <utility>

#include "softfinger/study/pagmo/gene_search.hpp"

namespace softfinger {
namespace {

struct StudyProblem {
  const GeneSearch* search = nullptr;

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>&) const {
    throw std::logic_error("a design was evaluated alone");  // batches alone
  }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return search == nullptr ? std::pair(std::vector{0.0}, std::vector{1.0})
                             : std::pair(search->least, search->most);
  }
  [[nodiscard]] std::size_t get_nix() const { return search == nullptr ? 0 : search->whole; }
  [[nodiscard]] std::size_t get_nobj() const { return search == nullptr ? 1 : search->objectives; }
};

/// Ours, in the place of pagmo's own threads.
struct StudyBatch {
  const GeneSearch* search = nullptr;

  std::vector<double> operator()(const pagmo::problem&, const std::vector<double>& genes) const {
    return search->fitness(genes);
  }
};

}  // namespace

extern "C" void softfinger_search_genes(const GeneSearch& search) {
  const pagmo::problem problem(StudyProblem{&search});
  const pagmo::bfe batch(StudyBatch{&search});
  pagmo::population population(problem, batch, search.size, search.seed);
  if (search.of_a_front) {
    pagmo::nsga2 algorithm(search.generations, 0.95, 10.0,
                           1.0 / static_cast<double>(problem.get_nx()), 50.0, search.seed);
    algorithm.set_bfe(batch);
    static_cast<void>(algorithm.evolve(std::move(population)));
    return;
  }
  pagmo::gaco algorithm(search.generations, std::min(63u, search.size), 1.0, 0.0, 0.01, 1, 7,
                        100000, 100000, 0.0, false, search.seed);
  algorithm.set_bfe(batch);
  static_cast<void>(algorithm.evolve(std::move(population)));
}

}  // namespace softfinger
