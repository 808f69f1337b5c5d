#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "pad.hpp"
#include "random_descent.hpp"
#include "softfinger/device/kinds/pin_array.hpp"
#include "softfinger/matching/pin_minimiser.hpp"
#include "softfinger/matching/pin_profile.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> pins(int rows, int columns, double pitch, double radius,
                                   double stroke) {
  const PinArrayGeometry geometry{rows, columns, pitch, radius, stroke, 0.0};
  DeviceSettings settings;
  settings.kind = "pin_array";
  settings.axes = PinDrives::axes_for(geometry);
  settings.X_FB.translation = Vector3(0.0, 0.0, -7.8 * mm);
  settings.home = Configuration::Zero(rows * columns);
  settings.retracted = settings.home;
  LinearDrives::set_joint_limits(settings, 50.0 * mm);
  return make_pin_array(std::move(settings), geometry);
}

/// Moves pins one by one to the best of many heights until none gains.
double pin_by_pin(const Device& device, const SurfaceSamples& samples, Configuration q) {
  double value = device.deviation(q, samples);
  for (bool gained = true; gained;) {
    gained = false;
    for (int k = 0; k < q.size(); ++k) {
      const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
      constexpr int kHeights = 40;
      for (int i = 0; i <= kHeights; ++i) {
        Configuration trial = q;
        trial[k] = axis.min + (axis.max - axis.min) * i / kHeights;
        const double trial_value = device.deviation(trial, samples);
        if (trial_value >= value - 1e-13) continue;
        value = trial_value;
        q = trial;
        gained = true;
      }
    }
  }
  return value;
}

void expect_no_better_search(const std::shared_ptr<const Device>& device, unsigned seed,
                             int presses, int starts) {
  std::mt19937 random(seed);
  ContactSurfaceMatching matching(device, 120);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int touching = 0;
  for (int i = 0; i < presses; ++i) {
    const Pad pad = random_press(random, 25.0);
    if (pad.contacts() == 0) continue;
    ++touching;
    const PackedPad packed(pad);
    const MatchingResult result = matching.solve(pad.view(), {});
    EXPECT_EQ(result.termination, Termination::kConverged);
    EXPECT_TRUE(device->reachable(result.configuration));
    EXPECT_NEAR(result.deviation, device->deviation(result.configuration, packed.view()),
                1e-9 * result.deviation + 1e-18);
    double least = pin_by_pin(*device, packed.view(), result.configuration);
    for (int start = 0; start < starts; ++start) {
      Configuration q(device->degrees_of_freedom());
      for (int k = 0; k < q.size(); ++k) {
        q[k] = device->axes()[static_cast<std::size_t>(k)].max * unit(random);
      }
      least = std::min(least, pin_by_pin(*device, packed.view(), q));
    }
    EXPECT_GE(least, 0.98 * result.deviation - 1e-14) << "press " << i;
  }
  EXPECT_GT(touching, presses / 2);
}

TEST(PinMatching, NoPinByPinSearchFindsLess) {
  expect_no_better_search(pins(6, 6, 2.0 * mm, 0.5 * mm, 2.0 * mm), 1, 10, 3);
}
TEST(PinMatching, NoPinByPinSearchFindsLessWithLongStrokes) {
  expect_no_better_search(pins(4, 4, 3.0 * mm, 1.2 * mm, 5.0 * mm), 2, 12, 8);
}
TEST(PinMatching, NoPinByPinSearchFindsLessWithDensePins) {
  expect_no_better_search(pins(8, 8, 1.0 * mm, 0.5 * mm, 3.0 * mm), 3, 3, 2);
}

// What no sample can see stays at home, and what is not needed comes back to it.
TEST(PinMatching, PinsWithoutSamplesStayHome) {
  const auto device = pins(10, 10, 2.0 * mm, 0.5 * mm, 3.0 * mm);
  ContactSurfaceMatching matching(device, 120);
  Pad pad;
  pad.points = {Vector3(1.0 * mm, 1.0 * mm, -6.8 * mm)};
  pad.in_contact = {1};
  pad.areas = {1.0};
  pad.gaps = {0.0};
  Configuration warm = Configuration::Constant(100, 2.0 * mm);
  for (const Configuration* start :
       {static_cast<const Configuration*>(nullptr), &std::as_const(warm)}) {
    const MatchingResult result = matching.solve(pad.view(), {}, start);
    EXPECT_LT(result.deviation, 1e-16);
    int raised = 0;
    for (const double height : result.configuration) {
      if (height == 0.0) continue;
      EXPECT_NEAR(height, 1.0 * mm, 1e-9);
      ++raised;
    }
    EXPECT_EQ(raised, 1);
  }
}

TEST(PinMatching, LimitsCutWhatIsWanted) {
  const auto device = pins(6, 6, 2.0 * mm, 0.5 * mm, 0.5 * mm);
  std::mt19937 random(5);
  ContactSurfaceMatching matching(device, 120);
  const Pad pad = press_plane(resting_pad(120, random), {0.0, 0.0, -5.8 * mm}, Vector3::UnitZ());
  MatchingOptions options;
  const MatchingResult inside = matching.solve(pad.view(), options);
  options.limits = MatchingLimits::kClamp;
  const MatchingResult clamped = matching.solve(pad.view(), options);
  options.limits = MatchingLimits::kNone;
  const MatchingResult unlimited = matching.solve(pad.view(), options);
  EXPECT_LE(inside.configuration.maxCoeff(), 0.5 * mm);
  EXPECT_LE(clamped.configuration.maxCoeff(), 0.5 * mm);
  EXPECT_NEAR(unlimited.configuration.maxCoeff(), 2.0 * mm, 1e-9);
  EXPECT_LE(unlimited.deviation, inside.deviation);
  EXPECT_LE(inside.deviation, clamped.deviation * (1.0 + 1e-9));
  EXPECT_TRUE(inside.joints_exist);
  EXPECT_TRUE(inside.active_constraints.any());
  EXPECT_FALSE(unlimited.joints_exist);
  EXPECT_FALSE(matching.limit_names(inside).empty());
}

TEST(PinMatching, SixteenBySixteenWork) {
  const auto device = pins(16, 16, 1.2 * mm, 0.5 * mm, 3.0 * mm);
  std::mt19937 random(6);
  ContactSurfaceMatching matching(device, 120);
  for (int i = 0; i < 10; ++i) {
    const Pad pad = random_press(random, 25.0);
    const MatchingResult result = matching.solve(pad.view(), {});
    EXPECT_EQ(result.termination, Termination::kConverged);
    EXPECT_LE(result.deviation, device->deviation(device->home(), PackedPad(pad).view()));
  }
}

/// E by its definition, every sample against every pin.
double deviation_by_definition(const PinField& field, const Configuration& q,
                               const SurfaceSamples& samples) {
  double sum = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = field.in_mount({samples.x[s], samples.y[s], samples.z[s]});
    double least = 1.0;
    for (int pin = 0; pin < field.count(); ++pin) {
      const double beyond = field.beyond(pin, p_B.x(), p_B.y());
      const double above = p_B.z() - q[pin];
      least = std::min(least, i < samples.contact_count ? std::hypot(std::max(0.0, beyond), above)
                                                        : pin_distance(beyond, above).distance);
    }
    const double lack =
        i < samples.contact_count ? least : std::min(0.0, least - samples.margin[s]);
    sum += samples.weight[s] * lack * lack;
  }
  return sum;
}

/// Pins moved in turn, each by a profile of every sample against every pin.
Configuration moved_in_turn(const Device& device, const SurfaceSamples& samples) {
  const PinField& field = *device.pin_field();
  Configuration q = device.home();
  PinProfile profile(samples.size());
  const auto distance = [&](int i, int pin) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = field.in_mount({samples.x[s], samples.y[s], samples.z[s]});
    const double beyond = field.beyond(pin, p_B.x(), p_B.y());
    const double above = p_B.z() - q[pin];
    if (i >= samples.contact_count) return pin_distance(beyond, above).distance;
    return std::max(0.0, beyond) * std::max(0.0, beyond) + above * above;
  };
  for (bool moved = true; moved;) {
    moved = false;
    for (int pin = 0; pin < field.count(); ++pin) {
      profile.clear();
      for (int i = 0; i < samples.size(); ++i) {
        const auto s = static_cast<std::size_t>(i);
        double others = std::numeric_limits<double>::infinity();
        for (int other = 0; other < field.count(); ++other) {
          if (other != pin) others = std::min(others, distance(i, other));
        }
        const Vector3 p_B = field.in_mount({samples.x[s], samples.y[s], samples.z[s]});
        const double beyond = field.beyond(pin, p_B.x(), p_B.y());
        if (i < samples.contact_count) {
          const double aside = std::max(0.0, beyond);
          profile.add_contact(samples.weight[s], p_B.z(), aside * aside, others);
        } else {
          profile.add_clear(samples.weight[s], p_B.z(), beyond, samples.margin[s],
                            std::max(0.0, samples.margin[s] - others));
        }
      }
      const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(pin)];
      const double height = profile.minimise(axis.min, axis.max, device.home()[pin]);
      moved = moved || std::abs(height - q[pin]) >= 1e-10;
      q[pin] = height;
    }
  }
  return q;
}

// What is out of reach is left out of sums, distances and profiles, and that changes nothing.
TEST(PinMatching, WhatIsOutOfReachChangesNothing) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const auto& device :
       {pins(6, 6, 2.0 * mm, 0.5 * mm, 2.0 * mm), pins(5, 5, 3.0 * mm, 1.2 * mm, 5.0 * mm)}) {
    PinMinimiser minimiser(*device, 120);
    for (int i = 0; i < 30; ++i) {
      const PackedPad packed(random_press(random, 25.0));
      const SurfaceSamples samples = packed.view();
      Configuration q(device->degrees_of_freedom());
      for (double& height : q) height = device->axes()[0].max * unit(random);
      EXPECT_EQ(device->deviation(q, samples),
                deviation_by_definition(*device->pin_field(), q, samples));
      minimiser.take(samples, true);
      const PinMinimiser::Outcome outcome = minimiser.minimise(device->home(), 60);
      const Configuration uncut = moved_in_turn(*device, samples);
      EXPECT_TRUE(outcome.converged);
      EXPECT_LT((outcome.q - uncut).cwiseAbs().maxCoeff(), 1e-9) << i;
      const double expected = deviation_by_definition(*device->pin_field(), uncut, samples);
      EXPECT_NEAR(outcome.deviation, expected, 1e-12 * expected + 1e-22);
    }
  }
}

// The derivatives, which leave the same out, against the base class's, which go sample by sample.
TEST(PinMatching, DerivativesAreThoseOfEverySample) {
  const auto device = pins(5, 5, 3.0 * mm, 1.2 * mm, 5.0 * mm);
  std::mt19937 random(10);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Eigen::Index n = device->degrees_of_freedom();
  Eigen::VectorXd gradient(n);
  Eigen::VectorXd expected_gradient(n);
  Eigen::MatrixXd gauss_newton(n, n);
  Eigen::MatrixXd expected_gauss_newton(n, n);
  Eigen::MatrixXd hessian(n, n);
  for (int i = 0; i < 30; ++i) {
    const PackedPad packed(random_press(random, 25.0));
    const SurfaceSamples samples = packed.view();
    Configuration q(n);
    for (double& height : q) height = device->axes()[0].max * unit(random);
    const double value = device->deviation_derivatives(q, samples, gradient, gauss_newton, hessian);
    const double expected = device->Device::deviation_derivatives(q, samples, expected_gradient,
                                                                  expected_gauss_newton, hessian);
    EXPECT_NEAR(value, expected, 1e-12 * expected);
    EXPECT_LT((gradient - expected_gradient).norm(), 1e-12 * expected_gradient.norm());
    EXPECT_LT((gauss_newton - expected_gauss_newton).norm(), 1e-12 * expected_gauss_newton.norm());
  }
}

// The sweep against a dense search of the same sum, written as it is defined.
TEST(PinProfileMinimum, AgreesWithDenseSearch) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  PinProfile profile(40);
  for (int trial = 0; trial < 300; ++trial) {
    struct Piece {
      bool touching;
      double weight, z, beyond, margin, others;
    };
    std::vector<Piece> pieces;
    profile.clear();
    for (int i = 0; i < 12; ++i) {
      Piece piece{unit(random) < 0.5,      0.5 + unit(random),
                  3.0 * mm * unit(random), (unit(random) - 0.5) * 0.6 * mm,
                  0.3 * mm * unit(random), 0.0};
      if (piece.touching) {
        piece.beyond = std::max(0.0, piece.beyond);
        piece.others = (unit(random) < 0.2 ? 1.0 : unit(random) * 1e-3) * mm;
        profile.add_contact(piece.weight, piece.z, piece.beyond * piece.beyond, piece.others);
      } else {
        piece.others = unit(random) < 0.3 ? 0.2 * piece.margin : 0.0;
        profile.add_clear(piece.weight, piece.z, piece.beyond, piece.margin, piece.others);
      }
      pieces.push_back(piece);
    }
    const auto value = [&](double h) {
      double sum = 0.0;
      for (const Piece& piece : pieces) {
        const double above = piece.z - h;
        if (piece.touching) {
          sum += piece.weight * std::min(piece.others, piece.beyond * piece.beyond + above * above);
        } else {
          const double lack =
              std::max(piece.others, piece.margin - pin_distance(piece.beyond, above).distance);
          sum += piece.weight * lack * lack;
        }
      }
      return sum;
    };
    double least = 1.0;
    for (int i = 0; i <= 20000; ++i) least = std::min(least, value(3.0 * mm * i / 20000.0));
    const double height = profile.minimise(0.0, 3.0 * mm, 1.0 * mm);
    EXPECT_GE(height, 0.0);
    EXPECT_LE(height, 3.0 * mm);
    EXPECT_LE(value(height), 1.002 * least + 1e-15);
  }
}

}  // namespace
}  // namespace softfinger
