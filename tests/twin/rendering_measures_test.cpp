#include "softfinger/twin/rendering_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/twin/perception.hpp"

namespace softfinger {
namespace {

/// A side whose places, a millimetre apart along x, have these areas (mm2) and bear these normal
/// forces (N) along z; those with a force are in contact.
struct Places {
  ContactSums sums;
  std::vector<double> areas, pressures;
  std::vector<std::uint8_t> touched;
};

Places places_of(const std::vector<double>& areas, const std::vector<double>& forces) {
  Places side;
  ContactSums& sums = side.sums;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double area = areas[i] * mm2;
    side.areas.push_back(area);
    side.pressures.push_back(forces[i] / area);
    side.touched.push_back(forces[i] > 0.0 ? 1 : 0);
    if (!(forces[i] > 0.0)) continue;
    ++sums.contact_count;
    sums.contact_area += area;
    sums.normal_force += forces[i];
    sums.centroid_F += forces[i] * Vector3(static_cast<double>(i) * mm, 0.0, 0.0);
  }
  if (sums.normal_force > 0.0) sums.centroid_F /= sums.normal_force;
  sums.mean_normal_F = Vector3::UnitZ();
  return side;
}

/// With the same tissue, of two cells, in every case.
RenderingMeasures compare_contacts(const Places& v, const Places& t) {
  const std::vector<double> v_energy{1.0, 2.0};
  const std::vector<double> t_energy{1.0, 4.0};
  const std::vector<double> volumes{3.0, 1.0};
  // By component: xx, yy, zz, yz, zx, xy.
  const std::vector<double> v_stress{1, 0, 0, 3, 0, 0, 2, 0, 0, 0, 0, 0};
  const std::vector<double> t_stress{1, 0, 0, 3, 0, 2, 1, 0, 0, 0, 0, 0};
  return compare({v.sums, v.touched, v.pressures, v_energy, v_stress},
                 {t.sums, t.touched, t.pressures, t_energy, t_stress}, {v.areas, v.areas, volumes});
}

TEST(RenderingMeasures, AreThoseOfAWorkedExample) {
  const Places v = places_of({1, 2, 3, 4}, {0.2, 0.4, 0.0, 0.0});
  Places t = places_of({1, 2, 3, 4}, {0.0, 0.4, 0.3, 0.0});
  t.sums.mean_normal_F = Vector3(std::sin(0.1), 0.0, std::cos(0.1));
  const RenderingMeasures m = compare_contacts(v, t);
  EXPECT_EQ(m.kind, FrameKind::kBoth);
  EXPECT_NEAR(m.iou, 2.0 / 6.0, 1e-12);  // common: 2 mm2, either: 1 + 2 + 3
  EXPECT_NEAR(m.normal_force_bias, 0.1 / 0.6, 1e-12);
  EXPECT_NEAR(m.normal_force_error, 0.1 / 0.6, 1e-12);
  EXPECT_NEAR(m.contact_area_error, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(m.normal_angle, 0.1, 1e-12);
  // Centroids at 0.4 / 0.6 and (0.4 + 0.6) / 0.7 mm.
  EXPECT_NEAR(m.centroid_shift, (1.0 / 0.7 - 0.4 / 0.6) * mm, 1e-12);
  // Pressures 0.2, 0.2, 0 against 0, 0.2, 0.1 N/mm2, weighted by 1, 2, 3.
  EXPECT_NEAR(m.pressure_error, std::sqrt((0.04 + 3 * 0.01) / (0.04 + 2 * 0.04)), 1e-12);
  EXPECT_NEAR(m.strain_energy_density_error, std::sqrt(4.0 / (3.0 + 4.0)), 1e-12);
  // Shear counts twice: 3 (1 + 2 * 4) + 9 at most, of which 3 * 2 * 1 + 4 differ.
  EXPECT_NEAR(m.stress_error, std::sqrt(10.0 / 36.0), 1e-12);
}

TEST(RenderingMeasures, TangentialForcesAreComparedAsVectors) {
  Places v = places_of({1, 2}, {0.2, 0.4});
  Places t = v;
  v.sums.tangential_force_F = Vector3(0.3, 0.0, 0.0);
  t.sums.tangential_force_F = Vector3(0.0, 0.4, 0.0);
  v.sums.slip_ratio = 1.0;
  t.sums.slip_ratio = 0.25;
  const RenderingMeasures m = compare_contacts(v, t);
  EXPECT_NEAR(m.tangential_force_error, 0.5 / 0.6, 1e-12);
  EXPECT_NEAR(m.slip_ratio_error, 0.75, 1e-12);
  // The other way round they are the same, as long as the normal forces are.
  EXPECT_EQ(compare_contacts(t, v).tangential_force_error, m.tangential_force_error);
  // Against a least force, as the normal one.
  v.sums.normal_force = 0.01;
  EXPECT_NEAR(compare_contacts(v, t).tangential_force_error, 0.5 / 0.05, 1e-12);
}

TEST(RenderingMeasures, NoFrameIsFreeInWhichASideBearsForce) {
  const Places free = places_of({1, 2}, {0.0, 0.0});
  for (double ContactSums::*force : {&ContactSums::normal_force, &ContactSums::normal_force_sum,
                                     &ContactSums::tangential_force}) {
    Places bearing = free;  // but its contact set is empty
    bearing.sums.*force = 0.009;
    EXPECT_EQ(compare_contacts(bearing, free).kind, FrameKind::kFree);
    bearing.sums.*force = 0.011;
    const RenderingMeasures missed = compare_contacts(bearing, free);
    EXPECT_EQ(missed.kind, FrameKind::kMissed);
    EXPECT_EQ(missed.iou, 0.0);
    EXPECT_EQ(compare_contacts(free, bearing).kind, FrameKind::kFalse);
    const RenderingMeasures both = compare_contacts(bearing, bearing);
    EXPECT_EQ(both.kind, FrameKind::kBoth);
    EXPECT_TRUE(std::isnan(both.iou)) << "no area to have in common";
    EXPECT_TRUE(std::isnan(both.contact_area_error));
    EXPECT_TRUE(std::isnan(both.centroid_shift));
    EXPECT_EQ(both.normal_force_error, 0.0);
  }
}

TEST(RenderingMeasures, OfASideWithItselfAreZero) {
  const Places v = places_of({1, 2, 3}, {0.2, 0.4, 0.0});
  const std::vector<double> energy{1.0, 2.0};
  std::vector<double> stress(12);
  std::iota(stress.begin(), stress.end(), 1.0);
  const LaidSide side{v.sums, v.touched, v.pressures, energy, stress};
  const RenderingMeasures m = compare(side, side, {v.areas, v.areas, energy});
  EXPECT_EQ(m.iou, 1.0);
  for (const MeasureName& name : measure_names()) {
    if (name.name != "iou") {
      EXPECT_EQ(m.*name.member, 0.0) << name.name;
    }
  }
}

TEST(RenderingMeasures, SmallForcesAreMeasuredAgainstALeastForce) {
  const Places v = places_of({1}, {0.01});
  const Places t = places_of({1}, {0.02});
  EXPECT_NEAR(compare_contacts(v, t).normal_force_error, 0.01 / 0.05, 1e-12);
}

TEST(RenderingMeasures, TellWhichSideTouches) {
  const Places touching = places_of({1, 2}, {0.2, 0.0});
  const Places free = places_of({1, 2}, {0.0, 0.0});
  MeasureMeans means;
  const RenderingMeasures none = compare_contacts(free, free);
  EXPECT_EQ(none.kind, FrameKind::kFree);
  EXPECT_TRUE(std::isnan(none.iou));
  const RenderingMeasures missed = compare_contacts(touching, free);
  EXPECT_EQ(missed.kind, FrameKind::kMissed);
  EXPECT_EQ(missed.iou, 0.0);
  EXPECT_TRUE(std::isnan(missed.normal_force_error));
  const RenderingMeasures wrong = compare_contacts(free, touching);
  EXPECT_EQ(wrong.kind, FrameKind::kFalse);
  for (const auto& measures : {none, missed, wrong, compare_contacts(touching, touching)}) {
    means.add(measures);
  }
  EXPECT_EQ(means.frames(FrameKind::kFree), 1);
  EXPECT_EQ(means.frames(FrameKind::kMissed), 1);
  EXPECT_EQ(means.frames(FrameKind::kFalse), 1);
  EXPECT_NEAR(means.mean().iou, 1.0 / 3.0, 1e-12);  // free frames are left out, wrong ones count
  EXPECT_EQ(means.mean().normal_force_error, 0.0);
}

TEST(Perception, NamesMeasuresThatExist) {
  for (const PerceptionThreshold& threshold : perception_thresholds()) {
    EXPECT_EQ(perception_threshold(threshold.measure), &threshold);
    bool known = false;
    for (const MeasureName& name : measure_names()) known = known || name.name == threshold.measure;
    EXPECT_TRUE(known) << threshold.measure;
    EXPECT_GT(threshold.threshold, 0.0);
  }
  EXPECT_EQ(perception_threshold("iou"), nullptr);
}

}  // namespace
}  // namespace softfinger
