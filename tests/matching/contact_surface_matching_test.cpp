#include "softfinger/matching/contact_surface_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "multipliers.hpp"
#include "pad.hpp"
#include "random_descent.hpp"
#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {
namespace {

/// E by its definition, sample by sample.
double deviation(const Pad& pad, const Configuration& q, double eps, bool scene) {
  double sum = 0.0;
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    if (pad.in_contact[i] != 0) {
      sum += thimble()->closest_point_residual(q, pad.points[i]).residual.squaredNorm();
    } else {
      const double margin = scene ? std::max(0.0, std::min(eps, pad.gaps[i])) : eps;
      const double lack =
          std::min(0.0, thimble()->signed_distance(q, pad.points[i]).distance - margin);
      sum += lack * lack;
    }
  }
  return sum;
}

/// Least E over the workspace by 24 random starts.
double brute_force(const Pad& pad, std::mt19937& random) {
  const PackedPad packed(pad);
  std::uniform_real_distribution<double> tilt(-30.0, 30.0);
  std::uniform_real_distribution<double> travel(-7.0, 12.0);
  double least = 1.0;
  for (int start = 0; start < 24; ++start) {
    Configuration q;
    do {
      q = configuration(tilt(random), tilt(random), travel(random));
    } while (!thimble()->reachable(q));
    least = std::min(least, descend_at_random(*thimble(), packed.view(), q, random));
  }
  return least;
}

void expect_global(double tilt_deg, unsigned seed, int presses) {
  std::mt19937 random(seed);
  ContactSurfaceMatching matching(thimble(), 200);
  int limited = 0;
  int touching = 0;
  for (int i = 0; i < presses; ++i) {
    const Pad pad = random_press(random, tilt_deg);
    if (pad.contacts() == 0) continue;
    ++touching;
    const MatchingResult result = matching.solve(pad.view(), {});
    EXPECT_EQ(result.termination, Termination::kConverged);
    EXPECT_TRUE(thimble()->reachable(result.configuration));
    EXPECT_TRUE(result.joints_exist);
    EXPECT_NEAR(result.deviation, deviation(pad, result.configuration, 0.2 * mm, true),
                1e-9 * result.deviation + 1e-20);
    EXPECT_LE(result.deviation, 1.001 * brute_force(pad, random) + 1e-14) << "press " << i;
    limited += result.active_constraints.any() ? 1 : 0;
  }
  EXPECT_GT(touching, presses / 2);
  if (tilt_deg > 40.0) {
    EXPECT_GT(limited, presses / 6);
  }
}

TEST(Matching, FindsTheGlobalMinimumInsideTheLimits) { expect_global(20.0, 11, 60); }
TEST(Matching, FindsTheGlobalMinimumAtTheLimits) { expect_global(45.0, 12, 60); }

TEST(Matching, FindsTheGlobalMinimumOfScatteredContacts) {
  std::mt19937 random(13);
  ContactSurfaceMatching matching(thimble(), 200);
  std::normal_distribution<double> noise(0.0, 1.0 * mm);
  std::bernoulli_distribution coin(0.15);
  for (int i = 0; i < 40; ++i) {
    Pad pad = random_press(random, 25.0);
    for (std::size_t k = 0; k < pad.points.size(); ++k) {
      pad.points[k] += Vector3(noise(random), noise(random), noise(random));
      pad.in_contact[k] = coin(random) ? 1 : 0;
    }
    const MatchingResult result = matching.solve(pad.view(), {});
    EXPECT_LE(result.deviation, 1.001 * brute_force(pad, random) + 1e-14) << i;
  }
}

// At the minimum the gradient of E vanishes in every direction that the limits leave free.
TEST(Matching, ProjectedGradientVanishes) {
  std::mt19937 random(14);
  ContactSurfaceMatching matching(thimble(), 200);
  int touching = 0;
  for (int i = 0; i < 200; ++i) {
    const Pad pad = random_press(random, 40.0);
    if (pad.contacts() < 3) continue;
    ++touching;
    const MatchingResult result = matching.solve(pad.view(), {});
    Eigen::Vector3d gradient;
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-8 / thimble()->axes()[static_cast<std::size_t>(k)].metric;
      Configuration a = result.configuration;
      Configuration b = a;
      a[k] += h;
      b[k] -= h;
      gradient[k] = (deviation(pad, a, 0.2 * mm, true) - deviation(pad, b, 0.2 * mm, true)) / 2e-8;
    }
    const int count = thimble()->constraint_count();
    Eigen::VectorXd values(count);
    Eigen::MatrixXd jacobian(count, 3);
    ASSERT_TRUE(thimble()->constraints(result.configuration, values, jacobian));
    Eigen::MatrixXd active(0, 3);
    for (int k = 0; k < count; ++k) {
      if (!result.active_constraints.test(static_cast<std::size_t>(k))) continue;
      active.conservativeResize(active.rows() + 1, 3);
      active.row(active.rows() - 1) = jacobian.row(k);
      for (int j = 0; j < 3; ++j) {
        active(active.rows() - 1, j) /= thimble()->axes()[static_cast<std::size_t>(j)].metric;
      }
    }
    if (active.rows() > 0) {
      const std::optional<Eigen::VectorXd> push = multipliers(active, gradient);
      ASSERT_TRUE(push) << i;
      EXPECT_GE(push->minCoeff(), -1e-7);
      gradient += active.transpose() * *push;
    }
    // 1e-6 m of surface at 120 samples would be 1e-4.
    EXPECT_LT(gradient.norm(), 2e-7) << i;
  }
  EXPECT_GT(touching, 100);
}

TEST(Matching, RendersAPlaneExactly) {
  std::mt19937 random(15);
  ContactSurfaceMatching matching(thimble(), 200);
  std::uniform_real_distribution<double> tilt(-12.0, 12.0);
  std::uniform_real_distribution<double> depth(0.5, 2.5);
  int rendered = 0;
  for (int i = 0; i < 150; ++i) {
    const Configuration q = configuration(tilt(random), tilt(random), 3.0 + depth(random));
    const Pose X_FP = thimble()->surface_pose(q);
    const Pad pad = press_plane(resting_pad(120, random), X_FP.translation, X_FP.rotation.col(2));
    double farthest = 0.0;
    for (std::size_t k = 0; k < pad.points.size(); ++k) {
      const Vector3 p_P = X_FP.inverse() * pad.points[k];
      if (pad.in_contact[k] != 0) farthest = std::max(farthest, std::hypot(p_P.x(), p_P.y()));
    }
    if (farthest > 8.0 * mm || pad.contacts() < 3) continue;
    ++rendered;
    const MatchingResult result = matching.solve(pad.view(), {});
    EXPECT_LT(result.deviation, 1e-14);
    EXPECT_LT(thimble()->squared_distance(result.configuration, q), 1e-12);
    // The constant separation cannot: it pushes the disk off.
    MatchingOptions constant;
    constant.separation = Separation::kConstant;
    EXPECT_GT(matching.solve(pad.view(), constant).deviation, 1e-10);
  }
  EXPECT_GT(rendered, 30);
}

TEST(Matching, OfSeveralMinimisersTheNearestHome) {
  ContactSurfaceMatching matching(thimble(), 4);
  // One contact above the disk: travel alone reaches it.
  Pad pad;
  pad.points = {thimble()->surface_pose(thimble()->home()) * Vector3(0.0, 0.0, 2.0 * mm)};
  pad.in_contact = {1};
  for (const Configuration& warm :
       {configuration(0, 0, 0), configuration(15, -10, 4), configuration(-20, 12, -1)}) {
    MatchingOptions options;
    options.separation = Separation::kConstant;
    const MatchingResult result = matching.solve(pad.view(), options, &warm);
    EXPECT_LT(result.deviation, 1e-14);
    EXPECT_LT((result.configuration - configuration(0, 0, 2)).head(2).norm(), 1e-4);
    EXPECT_NEAR(result.configuration[2], 2.0 * mm, 1e-8);
  }
  // Off the centre tilting helps: all minimisers lie on E = 0, the nearest is found by search.
  pad.points = {thimble()->surface_pose(thimble()->home()) * Vector3(6.0 * mm, 0.0, 2.0 * mm)};
  MatchingOptions options;
  options.separation = Separation::kConstant;
  const MatchingResult result = matching.solve(pad.view(), options);
  double nearest = 1.0;
  for (double pitch = -20.0; pitch <= 20.0; pitch += 0.01) {
    Configuration q = configuration(pitch, 0.0, 0.0);  // travel that touches: sdist is linear in it
    for (int i = 0; i < 30; ++i) {
      const SurfaceDistance d = thimble()->signed_distance(q, pad.points[0]);
      q[2] -= d.distance / d.gradient[2];
    }
    nearest = std::min(nearest, thimble()->squared_distance(q, thimble()->home()));
  }
  EXPECT_NEAR(std::sqrt(thimble()->squared_distance(result.configuration, thimble()->home())),
              std::sqrt(nearest), 1e-6);
}

TEST(Matching, NothingInContactClearsEverySample) {
  std::mt19937 random(16);
  ContactSurfaceMatching matching(thimble(), 200);
  Pad pad = resting_pad(120, random);
  MatchingOptions options;
  options.separation = Separation::kConstant;
  MatchingResult result = matching.solve(pad.view(), options);
  EXPECT_EQ(result.configuration, thimble()->home());
  EXPECT_EQ(result.deviation, 0.0);
  // A pad that hangs lower than home.
  for (Vector3& p : pad.points) p.z() -= 4.0 * mm;
  result = matching.solve(pad.view(), options);
  double least = 1.0;
  for (const Vector3& p : pad.points) {
    least = std::min(least, thimble()->signed_distance(result.configuration, p).distance);
  }
  EXPECT_NEAR(least, 0.2 * mm, 1e-9);
}

TEST(Matching, WarmAndColdAgree) {
  std::mt19937 random(17);
  ContactSurfaceMatching matching(thimble(), 200);
  int touching = 0;
  for (int i = 0; i < 100; ++i) {
    const Pad pad = random_press(random, 20.0);
    if (pad.contacts() < 3) continue;
    ++touching;
    const MatchingResult cold = matching.solve(pad.view(), {});
    Configuration near = cold.configuration;
    near[0] += 0.01;
    near[2] -= 0.05 * mm;
    const MatchingResult warm = matching.solve(pad.view(), {}, &near);
    EXPECT_LT(std::sqrt(thimble()->squared_distance(warm.configuration, cold.configuration)), 1e-7);
  }
  EXPECT_GT(touching, 50);
}

TEST(Matching, OrderOfSamplesDoesNotMatter) {
  std::mt19937 random(18);
  ContactSurfaceMatching matching(thimble(), 200);
  int touching = 0;
  for (int i = 0; i < 50; ++i) {
    const Pad pad = random_press(random, 20.0);
    if (pad.contacts() < 3) continue;
    ++touching;
    std::vector<std::size_t> order(pad.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    Pad shuffled;
    for (const std::size_t k : order) {
      shuffled.points.push_back(pad.points[k]);
      shuffled.in_contact.push_back(pad.in_contact[k]);
      shuffled.areas.push_back(pad.areas[k]);
      shuffled.gaps.push_back(pad.gaps[k]);
    }
    const MatchingResult a = matching.solve(pad.view(), {});
    const MatchingResult b = matching.solve(shuffled.view(), {});
    EXPECT_NEAR(a.deviation, b.deviation, 1e-9 * a.deviation + 1e-18);
    EXPECT_LT(std::sqrt(thimble()->squared_distance(a.configuration, b.configuration)), 1e-7);
  }
  EXPECT_GT(touching, 25);
}

TEST(Matching, AreaWeightsWeigh) {
  std::mt19937 random(19);
  ContactSurfaceMatching matching(thimble(), 200);
  Pad pad = random_press(random, 10.0);
  MatchingOptions area;
  area.weights = MatchingWeights::kArea;
  const MatchingResult result = matching.solve(pad.view(), area);
  double sum = 0.0;
  const double mean = std::accumulate(pad.areas.begin(), pad.areas.end(), 0.0) / pad.size();
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    Pad one;
    one.points = {pad.points[i]};
    one.in_contact = {pad.in_contact[i]};
    one.gaps = {pad.gaps[i]};
    sum += pad.areas[i] / mean * deviation(one, result.configuration, 0.2 * mm, true);
  }
  EXPECT_NEAR(result.deviation, sum, 1e-9 * sum + 1e-20);
}

TEST(Matching, ClampCutsTheJointsOfTheUnlimitedOptimum) {
  std::mt19937 random(20);
  ContactSurfaceMatching matching(thimble(), 200);
  int cut = 0;
  for (int i = 0; i < 200; ++i) {
    const Pad pad = random_press(random, 45.0);
    if (pad.contacts() < 3) continue;
    MatchingOptions options;
    options.limits = MatchingLimits::kNone;
    const MatchingResult none = matching.solve(pad.view(), options);
    EXPECT_EQ(none.joints_exist, thimble()->reachable(none.configuration));
    options.limits = MatchingLimits::kClamp;
    const MatchingResult clamp = matching.solve(pad.view(), options);
    const MatchingResult inside = matching.solve(pad.view(), {});
    EXPECT_TRUE(thimble()->reachable(clamp.configuration));
    EXPECT_GE(clamp.deviation, inside.deviation * (1.0 - 1e-6) - 1e-16);
    EXPECT_LE(none.deviation, inside.deviation * (1.0 + 1e-6) + 1e-16);
    EXPECT_EQ(clamp.configuration, clamped_to_limits(*thimble(), none.configuration));
    if (thimble()->reachable(none.configuration)) {
      EXPECT_EQ(clamp.configuration, none.configuration);
      continue;
    }
    ++cut;
    JointAngles joints;
    thimble()->clamped_joints(none.configuration, joints);
    Configuration q;
    if (thimble()->forward_kinematics(joints, q)) {
      EXPECT_LT((clamp.joints - joints).norm(), 1e-7);
    } else {
      // On the segment from home, and a little further is outside.
      const Eigen::Vector3d way = none.configuration - thimble()->home();
      const Eigen::Vector3d went = clamp.configuration - thimble()->home();
      const double fraction = went.dot(way) / way.squaredNorm();
      EXPECT_LT((went - fraction * way).norm(), 1e-9);
      EXPECT_FALSE(thimble()->reachable(thimble()->home() + (fraction + 1e-6) * way));
    }
  }
  EXPECT_GT(cut, 20);
}

TEST(Matching, LimitNamesSayWhatIsInTheWay) {
  std::mt19937 random(21);
  ContactSurfaceMatching matching(thimble(), 200);
  const double tilt = 50.0 * deg;
  const Vector3 normal(std::sin(tilt), 0.0, std::cos(tilt));
  const Pad rest = resting_pad(120, random);
  double lowest = 1.0;
  for (const Vector3& p : rest.points) lowest = std::min(lowest, normal.dot(p));
  const Pad pad = press_plane(rest, (lowest + 2.0 * mm) * normal, normal);
  const MatchingResult result = matching.solve(pad.view(), {});
  const std::vector<std::string> names = matching.limit_names(result);
  EXPECT_NE(std::find(names.begin(), names.end(), "pitch_deg"), names.end());
  // Too deep: the legs end.
  Pad deep = rest;
  for (Vector3& p : deep.points) p.z() += 20.0 * mm;
  deep.in_contact.assign(deep.points.size(), 1);
  const std::vector<std::string> joints = matching.limit_names(matching.solve(deep.view(), {}));
  EXPECT_TRUE(std::any_of(joints.begin(), joints.end(),
                          [](const std::string& name) { return name.starts_with("joint_"); }));
}

// Nothing given may crash it, hang it or take it out of the workspace.
TEST(Matching, SurvivesAnything) {
  std::mt19937 random(22);
  ContactSurfaceMatching matching(thimble(), 30);
  std::uniform_real_distribution<double> wide(-60.0, 60.0);
  std::bernoulli_distribution coin(0.5);
  for (int i = 0; i < 500; ++i) {
    Pad pad;
    for (int k = 0; k < 1 + i % 30; ++k) {
      pad.points.push_back(Vector3(wide(random), wide(random), wide(random)) * mm);
      pad.in_contact.push_back(coin(random) ? 1 : 0);
      pad.gaps.push_back(wide(random) * mm);
      pad.areas.push_back(1.0 * mm2);
    }
    for (const MatchingLimits limits :
         {MatchingLimits::kInside, MatchingLimits::kClamp, MatchingLimits::kNone}) {
      MatchingOptions options;
      options.limits = limits;
      const MatchingResult result = matching.solve(pad.view(), options);
      EXPECT_TRUE(result.configuration.allFinite());
      if (limits != MatchingLimits::kNone) {
        EXPECT_TRUE(thimble()->reachable(result.configuration));
      }
    }
  }
}

}  // namespace
}  // namespace softfinger
