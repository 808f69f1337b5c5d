#include "softfinger/tracking/registration/registration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "../support/turn_onto.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

constexpr double kTable = 730.0 * mm;

/// An egg, its origin not in the middle: 24 mm long, 16 broad, 13 deep.
std::vector<Vector3> egg() {
  std::vector<Vector3> skin;
  for (int i = 0; i <= 60; ++i) {
    for (int j = 0; j < 120; ++j) {
      const double polar = M_PI * i / 60.0, around = 2.0 * M_PI * j / 120.0;
      skin.emplace_back(1 * mm + 12 * mm * std::sin(polar) * std::cos(around),
                        8 * mm * std::sin(polar) * std::sin(around),
                        -0.5 * mm + 6.5 * mm * std::cos(polar));
    }
  }
  return skin;
}

double lowest(const std::vector<Vector3>& skin, const Matrix3& rotation) {
  double least = 1.0;
  for (const Vector3& p : skin) least = std::min(least, (rotation * p).z());
  return least;
}

/// A person: how the body sits on their finger, and how much larger than the egg that is.
struct Truth {
  Pose X_BodyFt;
  double scale = 1.0;
};

Truth random_truth(std::mt19937& random) {
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> scale(0.8, 1.3);
  const Vector3 axis = Vector3(any(random), any(random), any(random)).normalized();
  return {{exp_rotation(axis * std::uniform_real_distribution<double>(0.0, 3.1)(random)),
           15 * mm * Vector3(any(random), any(random), any(random))},
          scale(random)};
}

/// X_WBody where the finger rests in a posture, leaning by `lean` (rad) any way, somewhere on the
/// table, any way round.
Pose resting(const Truth& truth, Posture posture, double lean, std::mt19937& random) {
  std::normal_distribution<double> any;
  const Vector3 up = up_in_finger(posture);
  Matrix3 rotation = turn_onto(up, Vector3::UnitZ());
  const Vector3 axis = Vector3(any(random), any(random), 0.0).normalized();
  rotation = exp_rotation({0.0, 0.0, any(random)}) * exp_rotation(lean * axis) * rotation;
  const double height = kTable - truth.scale * lowest(egg(), rotation);
  const Pose X_WFt{rotation, {100 * mm * any(random), 100 * mm * any(random), height}};
  return X_WFt * truth.X_BodyFt.inverse();
}

PostureCapture capture(const Truth& truth, Posture posture, std::mt19937& random, double lean = 0.0,
                       double noise = 0.0, double turn_noise = 0.0) {
  std::normal_distribution<double> any;
  Pose X_WBody = resting(truth, posture, lean, random);
  X_WBody.rotation =
      X_WBody.rotation * exp_rotation(turn_noise * Vector3(any(random), any(random), any(random)));
  return {posture, X_WBody.rotation.row(2).transpose(),
          X_WBody.translation.z() + noise * any(random)};
}

std::vector<PostureCapture> captures(const Truth& truth, std::mt19937& random, double lean = 0.0,
                                     double noise = 0.0, double turn_noise = 0.0, int times = 1) {
  std::vector<PostureCapture> all;
  for (int k = 0; k < times; ++k) {
    for (const PostureRow& posture : kPostures) {
      all.push_back(capture(truth, posture.value, random, lean, noise, turn_noise));
    }
  }
  return all;
}

double turn_between(const Matrix3& a, const Matrix3& b) {
  return log_rotation(a.transpose() * b).norm();
}

std::vector<Vector3> scaled(std::vector<Vector3> skin, double scale) {
  for (Vector3& p : skin) p *= scale;
  return skin;
}

std::string refusal(const std::vector<PostureCapture>& all, std::optional<double> table = kTable,
                    bool size_known = false) {
  try {
    (void)register_finger(all, egg(), table, size_known);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing refused";
}

TEST(Registration, FindsBodyAndSizeFromATableOfKnownHeight) {
  std::mt19937 random(1);
  for (int k = 0; k < 50; ++k) {
    const Truth truth = random_truth(random);
    const Registration found = register_finger(captures(truth, random), egg(), kTable, false);
    EXPECT_LT((found.X_BodyFt.translation - truth.X_BodyFt.translation).norm(), 1e-3 * mm);
    EXPECT_LT(turn_between(found.X_BodyFt.rotation, truth.X_BodyFt.rotation), 1e-6);
    EXPECT_NEAR(found.scale, truth.scale, 1e-6);
    EXPECT_LT(found.height_residual, 1e-3 * mm);
  }
}

TEST(Registration, FindsBodyAndTableFromAFingerOfKnownSize) {
  std::mt19937 random(2);
  for (int k = 0; k < 50; ++k) {
    const Truth truth = random_truth(random);
    const Registration found =
        register_finger(captures(truth, random), scaled(egg(), truth.scale), std::nullopt, true);
    EXPECT_LT((found.X_BodyFt.translation - truth.X_BodyFt.translation).norm(), 1e-3 * mm);
    EXPECT_LT(turn_between(found.X_BodyFt.rotation, truth.X_BodyFt.rotation), 1e-6);
    EXPECT_NEAR(found.table_height, kTable, 1e-3 * mm);
    EXPECT_EQ(found.scale, 1.0);
  }
}

TEST(Registration, NoiseIsNotMadeLarger) {
  // Heights off by 0.2 mm and directions by half a degree: as much is wrong in what is found.
  std::mt19937 random(3);
  double worst_distance = 0.0, worst_turn = 0.0, worst_scale = 0.0;
  for (int k = 0; k < 200; ++k) {
    Truth truth = random_truth(random);
    truth.X_BodyFt.translation *= 0.5;
    const Registration found =
        register_finger(captures(truth, random, 0.0, 0.2 * mm, 0.5 * deg, 3), egg(), kTable, false);
    worst_distance =
        std::max(worst_distance, (found.X_BodyFt.translation - truth.X_BodyFt.translation).norm());
    worst_turn =
        std::max(worst_turn, turn_between(found.X_BodyFt.rotation, truth.X_BodyFt.rotation));
    worst_scale = std::max(worst_scale, std::abs(found.scale - truth.scale));
  }
  EXPECT_LT(worst_distance, 0.8 * mm);
  EXPECT_LT(worst_turn, 1.5 * deg);
  EXPECT_LT(worst_scale, 0.05);
}

TEST(Registration, PosturesThatLeanCostLess) {
  // Nobody rests exactly on a side: what leans by five degrees puts the body wrong by less.
  std::mt19937 random(4);
  double sum = 0.0;
  for (int k = 0; k < 100; ++k) {
    const Truth truth = random_truth(random);
    const Registration found =
        register_finger(captures(truth, random, 5.0 * deg), egg(), kTable, false);
    sum += turn_between(found.X_BodyFt.rotation, truth.X_BodyFt.rotation);
    EXPECT_LT(found.turn_residual, 15.0 * deg);
  }
  EXPECT_LT(sum / 100.0, 5.0 * deg);
}

TEST(Registration, OrderDoesNotMatter) {
  std::mt19937 random(5);
  const Truth truth = random_truth(random);
  std::vector<PostureCapture> all = captures(truth, random, 3.0 * deg, 0.2 * mm, 0.5 * deg, 2);
  const Registration first = register_finger(all, egg(), kTable, false);
  for (int k = 0; k < 20; ++k) {
    std::ranges::shuffle(all, random);
    const Registration again = register_finger(all, egg(), kTable, false);
    EXPECT_TRUE(again.X_BodyFt.translation.isApprox(first.X_BodyFt.translation, 1e-9));
    EXPECT_TRUE(again.X_BodyFt.rotation.isApprox(first.X_BodyFt.rotation, 1e-9));
    EXPECT_NEAR(again.scale, first.scale, 1e-9);
  }
}

TEST(Registration, PosturesInTheWrongOrderAreRefused) {
  // Two alone in each other's place are a mirror image of a finger, or worse.
  std::mt19937 random(6);
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      std::vector<PostureCapture> all = captures(random_truth(random), random);
      std::swap(all[a].posture, all[b].posture);
      EXPECT_THAT(refusal(all), HasSubstr("degrees off")) << a << b;
    }
  }
}

TEST(Registration, OnePostureThatIsAnotherIsNamed) {
  std::mt19937 random(7);
  const Truth truth = random_truth(random);
  for (std::size_t wrong = 1; wrong < 4; ++wrong) {
    std::vector<PostureCapture> all = captures(truth, random);
    all.push_back(all[0]);
    all[wrong].up_Body = all[0].up_Body;  // still flat
    EXPECT_THAT(refusal(all), HasSubstr(std::string(kPostures[wrong].name))) << wrong;
  }
}

TEST(Registration, WhatCannotBeAFingerOnATableIsRefused) {
  std::mt19937 random(8);
  const Truth truth = random_truth(random);
  std::vector<PostureCapture> all = captures(truth, random);
  EXPECT_THAT(refusal(all, kTable - 40 * mm), HasSubstr("height given for the table"));
  EXPECT_THAT(refusal(all, kTable + 40 * mm), HasSubstr("height given for the table"));
  EXPECT_THAT(refusal(all, std::nullopt, false), HasSubstr("give one"));
  const PostureCapture tip = all.back();
  all.pop_back();
  EXPECT_THAT(refusal(all), HasSubstr("'tip' was not captured"));
  all.push_back(tip);
  all.push_back(all.front());
  all.back().height += 15 * mm;  // the plate slipped
  EXPECT_THAT(refusal(all, kTable, true), HasSubstr("off the table"));
  std::vector<PostureCapture> far = captures({{Matrix3::Identity(), {0.6, 0, 0}}, 1.0}, random);
  EXPECT_THAT(refusal(far), HasSubstr("mm from the finger"));
}

// --- Procedure --------------------------------------------------------------------------------

/// Feeds poses 100 times a second.
class Procedure : public testing::Test {
 protected:
  void hold(const Pose& X_WBody, double seconds, double tremble = 0.0) {
    std::normal_distribution<double> any;
    for (int k = 0; k < std::lround(seconds * 100.0); ++k) {
      Pose pose = X_WBody;
      pose.translation += tremble * Vector3(any(random_), any(random_), any(random_));
      time_ += 0.01;
      procedure_.take({.time = time_, .X_WFt = pose, .valid = true});
    }
  }
  void lose(double seconds) {
    time_ += seconds;
    procedure_.take({.time = time_, .X_WFt = {}, .valid = false});
  }
  [[nodiscard]] std::size_t count() const { return procedure_.captures().size(); }
  Pose rest(Posture posture) { return resting(truth_, posture, 0.0, random_); }

  std::mt19937 random_{9};
  Truth truth_ = random_truth(random_);
  RegistrationProcedure procedure_;
  double time_ = 5.0;
};

TEST_F(Procedure, LeadsToTheRegistration) {
  for (const Posture posture : RegistrationProcedure::kOrder) {
    ASSERT_FALSE(procedure_.done());
    EXPECT_EQ(procedure_.wanted(), posture);
    hold(rest(posture), 1.1, 0.1 * mm);
  }
  ASSERT_TRUE(procedure_.done());
  const Registration found = register_finger(procedure_.captures(), egg(), kTable, false);
  EXPECT_LT((found.X_BodyFt.translation - truth_.X_BodyFt.translation).norm(), 0.1 * mm);
  EXPECT_LT(turn_between(found.X_BodyFt.rotation, truth_.X_BodyFt.rotation), 1e-6);
  EXPECT_NEAR(found.scale, truth_.scale, 0.01);
  hold(rest(Posture::kTip), 2.0);
  EXPECT_EQ(count(), 5U);  // and no more
}

TEST_F(Procedure, TakesAPostureAfterASecondAndNotTwice) {
  const Pose flat = rest(Posture::kPad);
  hold(flat, 0.95);
  EXPECT_EQ(count(), 0U);
  EXPECT_NEAR(procedure_.progress(), 0.95, 0.02);
  hold(flat, 0.1);
  EXPECT_EQ(count(), 1U);
  hold(flat, 3.0);
  EXPECT_EQ(count(), 1U);
  Pose turned = flat;  // about the vertical is no other posture
  turned.rotation = exp_rotation({0.0, 0.0, 2.0}) * flat.rotation;
  hold(turned, 3.0);
  EXPECT_EQ(count(), 1U);
  EXPECT_EQ(procedure_.progress(), 0.0);
}

TEST_F(Procedure, MotionOrLossBeginsTheSecondAnew) {
  Pose pose = rest(Posture::kPad);
  for (int k = 0; k < 5; ++k) {
    hold(pose, 0.9);
    pose.translation.x() += 1.5 * mm;
  }
  EXPECT_EQ(count(), 0U);
  for (int k = 0; k < 5; ++k) {
    hold(pose, 0.9);
    pose.rotation = pose.rotation * exp_rotation({0.0, 3.0 * deg, 0.0});
  }
  EXPECT_EQ(count(), 0U);
  for (int k = 0; k < 5; ++k) {
    hold(pose, 0.9);
    lose(0.01);
  }
  EXPECT_EQ(count(), 0U);
  for (int k = 0; k < 5; ++k) {
    hold(pose, 0.9);
    time_ += 0.3;  // nothing came
  }
  EXPECT_EQ(count(), 0U);
  hold(pose, 0.2);
  procedure_.take({.time = time_, .X_WFt = pose, .valid = true});  // the same again
  hold(pose, 0.9);
  EXPECT_EQ(count(), 1U);
}

TEST_F(Procedure, ASlowDriftIsNoRest) {
  Pose pose = rest(Posture::kPad);
  for (int k = 0; k < 400; ++k) {
    pose.translation.x() += 0.02 * mm;  // 2 mm/s
    hold(pose, 0.01);
  }
  EXPECT_EQ(count(), 0U);
}

}  // namespace
}  // namespace softfinger
