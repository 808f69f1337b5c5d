#pragma once

#include <functional>
#include <vector>

#include "softfinger/study/study.hpp"

namespace softfinger {

/// What designs came to, objective by objective, less is better; in their order. `designs`: the
/// free parameters' numbers.
using BatchFitness =
    std::function<std::vector<std::vector<double>>(const std::vector<std::vector<double>>&)>;

/// Whether this build has the library that searches (pagmo).
[[nodiscard]] bool can_search();

/// Searches as the study's plan says, generation by generation: a batch of `size` designs each,
/// the same ones for the same fitness. NSGA-II (Deb et al. 2002, IEEE Trans Evol Comput 6:182) for
/// several objectives, extended ant colony optimisation (Schlueter et al. 2009, Comput Oper Res
/// 36:2217) for one. Throws OperationError where !can_search().
void search(const Study& study, const BatchFitness& fitness);

}  // namespace softfinger
