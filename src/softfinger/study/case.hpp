#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/study/parameter.hpp"

namespace softfinger {

/// What is evaluated at once and recorded as one: a design, worn by one person.
struct StudyCase {
  Design design;
  std::uint32_t person = 0;  ///< number among the study's people

  [[nodiscard]] std::string bytes() const;
  [[nodiscard]] static StudyCase of_bytes(std::string_view bytes);
};

/// What it came to.
struct CaseOutcome {
  std::string reason;  ///< empty: it can be built and worn; else why not, one line
  std::vector<double>
      values;  ///< of what is measured, in the order of Study::quantities(); NaN: none

  [[nodiscard]] std::string bytes() const;
  [[nodiscard]] static CaseOutcome of_bytes(std::string_view bytes);
};

}  // namespace softfinger
