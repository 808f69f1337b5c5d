#pragma once

#include "softfinger/fem/constitutive_law.hpp"
#include "softfinger/fem/strain_limit.hpp"

namespace softfinger {

/// Laws in plain doubles, see constitutive_law.hpp. Not for kernels: what is inline here, any
/// translation unit may share.
struct DoubleArithmetic {
  using Number = double;
  static double all(double x) { return x; }
  static double min(double a, double b) { return a < b ? a : b; }
  static double max(double a, double b) { return a > b ? a : b; }
  static double select(bool condition, double a, double b) { return condition ? a : b; }
  static double quotient(double a, double w) { return a / w; }
  static double sum_of_strains(const double (&s)[3]) { return s[0] + s[1] + s[2] - 3.0; }
};

[[nodiscard]] inline StrainLimitResponse<double> strain_limit_at(const StrainLimit& limit,
                                                                 double stretch) {
  return strain_limit_at<DoubleArithmetic>(limit, stretch);
}

}  // namespace softfinger
