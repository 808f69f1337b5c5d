#include "softfinger/study/parameter.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

double Parameter::at(double u) const {
  if (is_discrete()) {
    const auto count = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::clamp(std::floor(u * count), 0.0, count - 1.0))];
  }
  const double value =
      log ? std::exp(std::log(min) + u * (std::log(max) - std::log(min))) : min + u * (max - min);
  return std::clamp(value, min, max);
}

Design complete_design(const std::vector<Parameter>& parameters,
                       const std::vector<double>& chosen) {
  Design design(parameters.size(), 0.0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].is_free()) design[i] = chosen[next++];
  }
  // A tie names free parameters and ties before it.
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i].is_free()) design[i] = parameters[i].tie->value(design);
  }
  return design;
}

}  // namespace softfinger
