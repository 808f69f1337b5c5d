#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "../support/folders.hpp"
#include "../support/turn_onto.hpp"
#include "multipliers.hpp"
#include "pad.hpp"
#include "random_descent.hpp"
#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/geometry/msh_file.hpp"

// Limits inside the optimisation against cutting joint angles afterwards, and against a search that
// knows nothing of either, where limits are often in the way.
namespace softfinger {
namespace {

constexpr int kCases = 10000;
constexpr int kSearched = 200;

/// The thimble with joints that leave home by 17 degrees down and 34 up, no further.
std::shared_ptr<const Device> narrow_thimble() {
  static const std::shared_ptr<const Device> device = [] {
    DeviceSettings settings = thimble()->settings();
    JointAngles home;
    EXPECT_TRUE(thimble()->inverse_kinematics(thimble()->home(), home));
    settings.joint_limits.min = home.array() - 17.0 * deg;
    settings.joint_limits.max = home.array() + 34.0 * deg;
    return make_platform_3rrs(
        std::move(settings), dynamic_cast<const Platform3rrs&>(thimble()->kinematics()).geometry());
  }();
  return device;
}

/// The resting skin of the shipped index finger.
Pad resting_index() {
  const TetrahedralMesh mesh = read_msh(source_folder() + "/fingers/index.msh", mm);
  std::vector<bool> is_skin(mesh.nodes.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[t])] != "skin") continue;
    for (const int node : mesh.triangles[t]) is_skin[static_cast<std::size_t>(node)] = true;
  }
  Pad pad;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (is_skin[n]) pad.points.push_back(mesh.nodes[n]);
  }
  pad.in_contact.assign(pad.points.size(), 0);
  pad.areas.assign(pad.points.size(), 1.0 * mm2);
  pad.gaps.assign(pad.points.size(), 0.0);
  return pad;
}

/// A plane, a ball or an edge pressed 0.3 to 2 mm into the resting skin, up to 30 degrees off.
Pad press_at_random(const Pad& rest, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double tilt = 30.0 * deg * unit(random);
  const double azimuth = 2.0 * std::numbers::pi * unit(random);
  const Vector3 normal(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                       std::cos(tilt));
  const Vector3 touch = *std::min_element(
      rest.points.begin(), rest.points.end(),
      [&](const Vector3& a, const Vector3& b) { return normal.dot(a) < normal.dot(b); });
  const Vector3 top = touch + (0.3 + 1.7 * unit(random)) * mm * normal;
  const double shape = 3.0 * unit(random);
  if (shape < 1.0) return press_plane(rest, top, normal);
  if (shape < 2.0) {
    const double radius = (4.0 + 16.0 * unit(random)) * mm;
    return press_ball(rest, top - radius * normal, radius);
  }
  // The roof of a wall 4 mm wide, whose edges of 1 mm radius run across the finger somehow.
  const Matrix3 upright = turn_onto(Vector3::UnitZ(), normal);
  const double turn = std::numbers::pi * unit(random);
  const RoundedBox wall{Vector3(2.0, 20.0, 10.0) * mm, 1.0 * mm};
  const Pose X_FO{upright * exp_rotation(turn * Vector3::UnitZ()), top - 10.0 * mm * normal};
  Pad pad = rest;
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    const SignedDistance d = signed_distance(wall, X_FO.inverse() * pad.points[i]);
    pad.in_contact[i] = d.distance <= 0.0;
    pad.gaps[i] = std::max(0.0, d.distance);
    if (d.distance < 0.0) pad.points[i] -= d.distance * (X_FO.rotation * d.gradient);
  }
  return pad;
}

bool joint_at_limit(const ContactSurfaceMatching& matching, const MatchingResult& result) {
  const std::vector<std::string> names = matching.limit_names(result);
  return std::any_of(names.begin(), names.end(),
                     [](const std::string& name) { return name.starts_with("joint_"); });
}

/// Least E over a dense grid of the workspace, descended from at the best of its points.
double grid_search(const Device& device, const SurfaceSamples& samples, std::mt19937& random) {
  constexpr std::size_t kBest = 8;
  std::vector<std::pair<double, Configuration>> found;
  for (int pitch = -28; pitch <= 28; pitch += 2) {
    for (int roll = -28; roll <= 28; roll += 2) {
      for (double travel = -4.0; travel <= 9.0; travel += 0.4) {
        const Configuration q = configuration(pitch, roll, travel);
        const double value = device.deviation(q, samples);
        if (found.size() == kBest && value >= found.back().first) continue;
        if (!device.reachable(q)) continue;
        if (found.size() == kBest) found.pop_back();
        found.insert(std::upper_bound(found.begin(), found.end(), value,
                                      [](double v, const auto& entry) { return v < entry.first; }),
                     {value, q});
      }
    }
  }
  double least = found.front().first;
  for (const auto& [value, q] : found) {
    least = std::min(least, descend_at_random(device, samples, q, random, 0.5 * mm));
  }
  return least;
}

/// Norm of E's gradient by (r pitch, r roll, travel) at q, without what limits that `inside` knows
/// of push back against; m.
double projected_gradient(const Device& device, const SurfaceSamples& samples,
                          const MatchingResult& result, bool inside) {
  Eigen::VectorXd gradient(3);
  Eigen::MatrixXd gauss_newton(3, 3);
  Eigen::MatrixXd hessian(3, 3);
  device.deviation_derivatives(result.configuration, samples, gradient, gauss_newton, hessian);
  const int count = device.constraint_count();
  Eigen::VectorXd values(count);
  Eigen::MatrixXd jacobian(count, 3);
  EXPECT_TRUE(device.constraints(result.configuration, values, jacobian));
  for (int k = 0; k < 3; ++k) {
    const double metric = device.axes()[static_cast<std::size_t>(k)].metric;
    gradient[k] /= metric;
    jacobian.col(k) /= metric;
  }
  std::vector<int> active;
  for (int k = 0; inside && k < count; ++k) {
    if (result.active_constraints.test(static_cast<std::size_t>(k))) active.push_back(k);
  }
  // The least over all sets of them with no multiplier below zero.
  double least = gradient.norm();
  for (unsigned set = 1; set < 1U << active.size(); ++set) {
    Eigen::MatrixXd rows(std::popcount(set), 3);
    int row = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      if ((set >> k & 1U) != 0) rows.row(row++) = jacobian.row(active[k]);
    }
    // Of rows that depend on each other some do as well as all.
    const std::optional<Eigen::VectorXd> push = multipliers(rows, gradient);
    if (!push || push->minCoeff() < 0.0) continue;
    least = std::min(least, (gradient + rows.transpose() * *push).norm());
  }
  return least;
}

TEST(MatchingLimits, InsideBeatsClampingAndStandsAgainstASearch) {
  const std::shared_ptr<const Device> device = narrow_thimble();
  const Pad rest = resting_index();
  ContactSurfaceMatching matching(device, rest.size());
  std::mt19937 random(31);
  std::mt19937 search_random(32);
  std::vector<double> ratios;  // of E inside and clamped, where a joint limit decides
  int searched = 0;
  for (int i = 0; i < kCases; ++i) {
    const Pad pad = press_at_random(rest, random);
    const PackedPad packed(pad);
    const auto solve = [&](MatchingLimits limits) {
      MatchingOptions options;
      options.limits = limits;
      const MatchingResult result = matching.solve(pad.view(), options);
      if (limits != MatchingLimits::kClamp && result.termination != Termination::kNonsmooth) {
        const double gradient =
            projected_gradient(*device, packed.view(), result, limits == MatchingLimits::kInside);
        // In mm, as the size of E that it is measured by.
        EXPECT_LE(gradient / mm / std::max(1.0, result.deviation / mm2), 1e-8)
            << i << " " << to_string(result.termination);
      }
      return result;
    };
    const MatchingResult inside = solve(MatchingLimits::kInside);
    const MatchingResult clamp = solve(MatchingLimits::kClamp);
    const MatchingResult none = solve(MatchingLimits::kNone);
    EXPECT_TRUE(device->reachable(inside.configuration));
    EXPECT_TRUE(device->reachable(clamp.configuration));
    EXPECT_LE(inside.deviation, clamp.deviation * (1.0 + 1e-12) + 1e-16 * mm2) << i;
    JointAngles joints;
    const bool at_limit = joint_at_limit(matching, inside);
    if (at_limit && device->inverse_kinematics(none.configuration, joints)) {
      ratios.push_back(inside.deviation / clamp.deviation);
    }
    // Every other of the searched at a limit.
    if (searched < kSearched && (at_limit || searched % 2 == 0)) {
      ++searched;
      const double least = grid_search(*device, packed.view(), search_random);
      EXPECT_LE(inside.deviation, 1.001 * least + 1e-14) << i;
    }
  }
  EXPECT_EQ(searched, kSearched);
  ASSERT_GT(ratios.size(), kCases / 20U);
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 0.9);
}

}  // namespace
}  // namespace softfinger
