#pragma once

namespace softfinger {

/// Value of a function of two variables (p, r) with its first and second derivatives; products
/// carry them along. Used for pitch and roll.
struct PlaneFunction {
  double v = 0.0;
  double p = 0.0, r = 0.0;
  double pp = 0.0, pr = 0.0, rr = 0.0;

  friend PlaneFunction operator*(const PlaneFunction& a, const PlaneFunction& b) {
    return {.v = a.v * b.v,
            .p = a.p * b.v + a.v * b.p,
            .r = a.r * b.v + a.v * b.r,
            .pp = a.pp * b.v + 2.0 * a.p * b.p + a.v * b.pp,
            .pr = a.pr * b.v + a.p * b.r + a.r * b.p + a.v * b.pr,
            .rr = a.rr * b.v + 2.0 * a.r * b.r + a.v * b.rr};
  }
  friend PlaneFunction operator+(const PlaneFunction& a, const PlaneFunction& b) {
    return {a.v + b.v, a.p + b.p, a.r + b.r, a.pp + b.pp, a.pr + b.pr, a.rr + b.rr};
  }
  friend PlaneFunction operator*(double k, const PlaneFunction& a) {
    return {k * a.v, k * a.p, k * a.r, k * a.pp, k * a.pr, k * a.rr};
  }
};

}  // namespace softfinger
