#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace softfinger {

/// A search as pagmo knows it, of vectors of genes between box bounds, whole numbers last.
struct GeneSearch {
  std::vector<double> least, most;  ///< of each gene
  std::size_t whole = 0;            ///< how many genes are whole numbers
  std::size_t objectives = 1;
  bool of_a_front = false;  ///< NSGA-II, else extended ant colony optimisation
  unsigned size = 0;        ///< of a generation
  unsigned generations = 0;
  unsigned seed = 0;
  /// Genes of a whole generation, one vector after the other, to their objectives, likewise; less
  /// is better. What it throws ends the search.
  std::function<std::vector<double>(const std::vector<double>& genes)> fitness;
};

/// In the module that links pagmo, kPagmoModule.
using SearchGenes = void (*)(const GeneSearch& search);
inline constexpr const char* kPagmoModule = "softfinger-pagmo.so";
inline constexpr const char* kSearchGenes = "softfinger_search_genes";

}  // namespace softfinger
