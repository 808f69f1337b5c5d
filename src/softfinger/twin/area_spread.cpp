#include "softfinger/twin/area_spread.hpp"

namespace softfinger {
namespace {

constexpr double kLeastSpread = 0.05;  // N

}  // namespace

void AreaSpread::add(double normal_force, double area) {
  count_ += 1.0;
  const double force_off = normal_force - mean_force_;
  mean_force_ += force_off / count_;
  mean_area_ += (area - mean_area_) / count_;
  force_squares_ += force_off * (normal_force - mean_force_);
  force_areas_ += force_off * (area - mean_area_);
}

double AreaSpread::rate() const {
  const bool varies = force_squares_ >= kLeastSpread * kLeastSpread * count_ && count_ > 1.0;
  return varies ? force_areas_ / force_squares_ : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace softfinger
