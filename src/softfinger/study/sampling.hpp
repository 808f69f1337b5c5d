#pragma once

#include <vector>

#include "softfinger/study/study.hpp"

namespace softfinger {

/// All designs of a study whose design is no search, in their order: the free parameters' numbers,
/// in theirs. A grid runs through the last parameter first. A Latin hypercube (McKay et al. 1979,
/// Technometrics 21:239) has each of `size` equal parts of each range once. Sobol's sequence (in
/// base 2 with the direction numbers of Joe and Kuo 2008, SIAM J Sci Comput 30:2635) is shifted,
/// bit by bit, by the seed.
[[nodiscard]] std::vector<std::vector<double>> sampled_designs(const Study& study);

}  // namespace softfinger
