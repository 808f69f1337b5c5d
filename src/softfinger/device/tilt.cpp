#include "softfinger/device/tilt.hpp"

#include <array>
#include <cmath>

namespace softfinger {
namespace {

/// A function of s = t^2 with two derivatives by s.
struct Radial {
  double v, d, dd;
};

// sum_k (-s)^k / (2k + first)!; in double exact to rounding for s <= 0.5.
template <int first>
constexpr auto series_coefficients() {
  std::array<double, 10> coefficients{};
  double factorial = 1.0;
  for (int i = 2; i <= first; ++i) factorial *= i;
  for (int k = 0; k < 10; ++k) {
    coefficients[static_cast<std::size_t>(k)] = (k % 2 == 0 ? 1.0 : -1.0) / factorial;
    factorial *= (2 * k + first + 1) * (2 * k + first + 2);
  }
  return coefficients;
}

template <int first>
Radial series(double s) {
  static constexpr auto kCoefficients = series_coefficients<first>();
  Radial sum{kCoefficients[9], 0.0, 0.0};
  for (int k = 8; k >= 0; --k) {  // Horner's scheme with both derivatives
    sum.dd = sum.dd * s + 2.0 * sum.d;
    sum.d = sum.d * s + sum.v;
    sum.v = sum.v * s + kCoefficients[static_cast<std::size_t>(k)];
  }
  return sum;
}

PlaneFunction in_plane(const Radial& f, double p, double r) {
  return {.v = f.v,
          .p = 2.0 * p * f.d,
          .r = 2.0 * r * f.d,
          .pp = 2.0 * f.d + 4.0 * p * p * f.dd,
          .pr = 4.0 * p * r * f.dd,
          .rr = 2.0 * f.d + 4.0 * r * r * f.dd};
}

}  // namespace

Tilt::Tilt(double pitch, double roll) {
  const double s = pitch * pitch + roll * roll;
  Radial sin_t{}, cos_t{};
  if (s <= 0.5) {
    sin_t = series<1>(s);
    cos_t = series<2>(s);
  } else {
    const double t = std::sqrt(s);
    sin_t.v = std::sin(t) / t;
    sin_t.d = (std::cos(t) - sin_t.v) / (2.0 * s);
    sin_t.dd = (-0.5 * sin_t.v - 3.0 * sin_t.d) / (2.0 * s);
    cos_t.v = (1.0 - std::cos(t)) / s;
    cos_t.d = (sin_t.v - 2.0 * cos_t.v) / (2.0 * s);
    cos_t.dd = (sin_t.d - 4.0 * cos_t.d) / (2.0 * s);
  }
  sine = in_plane(sin_t, pitch, roll);
  cosine = in_plane(cos_t, pitch, roll);
  const PlaneFunction p{.v = pitch, .p = 1.0};
  const PlaneFunction r{.v = roll, .r = 1.0};
  sine_p = sine * p;
  sine_r = sine * r;
  cosine_pp = cosine * PlaneFunction{.v = pitch * pitch, .p = 2.0 * pitch, .pp = 2.0};
  cosine_pr = cosine * PlaneFunction{.v = pitch * roll, .p = roll, .r = pitch, .pr = 1.0};
  cosine_rr = cosine * PlaneFunction{.v = roll * roll, .r = 2.0 * roll, .rr = 2.0};
}

Matrix3 Tilt::rotation() const { return Matrix3::Identity() + derivative(&PlaneFunction::v); }

Matrix3 Tilt::derivative(double PlaneFunction::*part) const {
  const double sp = sine_p.*part;
  const double sr = sine_r.*part;
  const double pp = cosine_pp.*part;
  const double pr = cosine_pr.*part;
  const double rr = cosine_rr.*part;
  Matrix3 m;
  m << -pp, pr, sp, pr, -rr, -sr, -sp, sr, -pp - rr;
  return m;
}

}  // namespace softfinger
