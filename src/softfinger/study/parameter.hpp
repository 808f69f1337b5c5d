#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/study/expression.hpp"

namespace softfinger {

/// Which of a study's files a number stands in.
enum class VariedFile { kDevice, kFinger, kScene };

/// A number of a device, finger or scene file that differs from design to design. In the unit of
/// the file throughout.
struct Parameter {
  std::string key;  ///< "device.geometry.crank_mm"
  VariedFile file = VariedFile::kDevice;
  std::string way;                        ///< in that file, "geometry.crank_mm"
  double min = 0.0, max = 0.0;            ///< of a range
  bool log = false;                       ///< the range's even steps are factors
  std::vector<double> values;             ///< one of these, instead of a range
  std::shared_ptr<const Expression> tie;  ///< follows from the others, instead of either

  /// It is chosen, and does not follow.
  [[nodiscard]] bool is_free() const { return tie == nullptr; }
  [[nodiscard]] bool is_discrete() const { return !values.empty(); }
  /// For u from 0 to 1, even: between min and max, or the value whose share of that u falls in.
  [[nodiscard]] double at(double u) const;
};

/// A design: one number a parameter.
using Design = std::vector<double>;

/// The design whose free parameters, in their order, are these; the others follow.
[[nodiscard]] Design complete_design(const std::vector<Parameter>& parameters,
                                     const std::vector<double>& chosen);

}  // namespace softfinger
