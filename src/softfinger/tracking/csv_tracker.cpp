#include "softfinger/tracking/csv_tracker.hpp"

#include <algorithm>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {

namespace {

// Times are written in decimals: a gap of 200 ms as written is not over 200 ms.
constexpr double kTimeRounding = 1e-9;  // s

TrackedPose tracked(const PoseSample& row, bool valid) {
  return {.time = row.time,
          .X_WFt = {.rotation = row.rotation_WFt.toRotationMatrix(), .translation = row.p_WFt},
          .valid = valid};
}

}  // namespace

CsvTracker::CsvTracker(std::vector<PoseSample> rows) : rows_(std::move(rows)) {
  if (rows_.empty()) throw InputError("a pose file needs at least one row");
}

TrackedPose CsvTracker::sample(double time) {
  const auto after = std::upper_bound(rows_.begin(), rows_.end(), time,
                                      [](double t, const PoseSample& row) { return t < row.time; });
  if (after == rows_.begin()) return tracked(rows_.front(), false);
  const PoseSample& last = *(after - 1);
  const double limit = kLostAfter + kTimeRounding;
  if (after == rows_.end() || after->time - last.time > limit) {
    return tracked(last, time - last.time <= limit);
  }
  // To the bit: other ways to hand over the same pose take no turn through an interpolation.
  if (time == last.time) return tracked(last, true);
  const double s = (time - last.time) / (after->time - last.time);
  PoseSample between{.time = time,
                     .p_WFt = last.p_WFt + s * (after->p_WFt - last.p_WFt),
                     .rotation_WFt = last.rotation_WFt.slerp(s, after->rotation_WFt)};
  between.rotation_WFt.normalize();
  return tracked(between, true);
}

std::optional<double> CsvTracker::end_time() const { return rows_.back().time; }

}  // namespace softfinger
