#pragma once

#include <cstddef>
#include <vector>

#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// The part of a number's variance that one parameter explains by itself, Sobol's first-order index
/// (Sobol 1993, Math Model Comput Exp 1:407), 0 to 1.
struct FirstOrderIndex {
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 of 100 resamplings of the designs lie between
};

/// For each parameter, of a quantity over all feasible designs, from the designs as they are: the
/// variance between means over equal shares of the designs along the parameter (Plischke, Borgonovo
/// and Smith 2013, Eur J Oper Res 226:536), less what chance puts there. Designs have to lie
/// evenly: those of a search do not. Empty: there are too few.
[[nodiscard]] std::vector<FirstOrderIndex> first_order_indices(const StudyTable& table,
                                                               std::size_t quantity);

}  // namespace softfinger
