// A device that learns its wearer: from the first press to the person's file, and to what is felt.

#include "softfinger/session/device_fit.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/table_rest.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/session/evaluation.hpp"

namespace softfinger {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

const std::filesystem::path kFitProject = source_folder();

class FittedDevice : public testing::Test {
 protected:
  [[nodiscard]] DeviceFitOptions options() const {
    DeviceFitOptions options;
    options.device = kFitProject / "devices" / "thimble-3rrs.toml";
    options.finger = kFitProject / "fingers" / "index.toml";
    options.wearer = kFitProject / "fingers" / "middle.toml";
    options.person = directory_ / "anna.toml";
    options.sensor = ForceSensorKind::kEmulator;
    options.sensor_noise = 0.02;
    options.guard_program = guard_program();
    return options;
  }
  [[nodiscard]] DeviceFitOptions options_by_touch() const {
    DeviceFitOptions by_touch = options();
    by_touch.sensor.reset();
    by_touch.sensor_noise.reset();
    by_touch.by_touch = true;
    return by_touch;
  }
  /// A finger file of the shape of index and another size.
  [[nodiscard]] std::filesystem::path sized(const char* name, const FingerSize& size) const {
    std::string text = read_text_file(options().finger, 100000);
    const std::string mesh = "file = \"";
    text.insert(text.find(mesh) + mesh.size(), (kFitProject / "fingers/").string());
    text += "\n[size]\n";
    if (size.length) text += fmt::format("length_mm = {}\n", *size.length / mm);
    if (size.breadth) text += fmt::format("breadth_mm = {}\n", *size.breadth / mm);
    if (size.depth) text += fmt::format("depth_mm = {}\n", *size.depth / mm);
    std::ofstream(directory_ / name) << text;
    return directory_ / name;
  }
  [[nodiscard]] bool is_written() const {
    return std::filesystem::exists(directory_ / "anna.toml");
  }
  void expect_refused(const DeviceFitOptions& options, const char* word) {
    const DeviceFit fit = fit_device(options, stop_);
    EXPECT_NE(fit.failure, "");
    EXPECT_THAT(fit.failure, HasSubstr(word));
    EXPECT_TRUE(fit.written.empty());
    EXPECT_FALSE(is_written());
    EXPECT_LT(fit.greatest_force, 2.0) << fit.failure;
  }

  const TemporaryDirectory directory_;
  std::atomic<bool> stop_{false};
};

/// A fit takes seconds: several tests look at this one.
struct FirstFit : FittedDevice {
  void TestBody() override {}
  const DeviceFitOptions fitted_with = options();
  const DeviceFit fit = fit_device(fitted_with, stop_);
  const std::string text = read_text_file(fitted_with.person, 10000);
};

const FirstFit& first_fit() {
  static const FirstFit first;
  return first;
}

/// Mean error of the normal force on a plane.
double force_error(const DeviceFitOptions& fitted, bool with_person) {
  EvaluationOptions options;
  options.run.scene = kFitProject / "scenes" / "plane.toml";
  options.run.devices = {fitted.device.string()};
  options.run.wearer = fitted.wearer;
  if (with_person) options.run.person = fitted.person;
  options.run.duration = 2.0;
  return evaluate(options, std::atomic<bool>{false}).commanded.mean().normal_force_error;
}

TEST_F(FittedDevice, PressesRightAfterwards) {
  const DeviceFit& fit = first_fit().fit;
  const DeviceFitOptions& options = first_fit().fitted_with;
  ASSERT_EQ(fit.failure, "");
  EXPECT_EQ(fit.presses, 9);
  EXPECT_LE(fit.duration, 20.0);
  EXPECT_LE(fit.greatest_force, 1.0);
  EXPECT_GT(fit.greatest_force, 0.5);
  EXPECT_LT(fit.estimate.predicted_force_error, kMostForetoldError);
  EXPECT_EQ(fit.written, options.person);
  ASSERT_EQ(fit.traits.size(), static_cast<std::size_t>(kWearerTraits));
  for (const DeviceFit::Told& told : fit.traits) {
    EXPECT_LT(told.ci95_low, told.value);
    EXPECT_LT(told.value, told.ci95_high);
  }
  const double before = force_error(options, false);
  const double after = force_error(options, true);
  EXPECT_GT(before, 0.4);
  EXPECT_LT(after, 0.12);
}

TEST_F(FittedDevice, ComesOutTheSameEachTimeAndOtherFingersStay) {
  const std::string ring = "# Anna\n[ring.size]\ndepth_mm = 12.5  # by calliper\n";
  std::ofstream(options().person) << ring;
  const DeviceFit fit = fit_device(options(), stop_);
  ASSERT_EQ(fit.failure, "");
  EXPECT_EQ(fit.estimate.x, first_fit().fit.estimate.x);
  const std::string text = read_text_file(options().person, 10000);
  EXPECT_THAT(text, HasSubstr(ring));
  const std::string& alone = first_fit().text;
  EXPECT_THAT(text, EndsWith(alone.substr(alone.find("[index.size]"))));
  EXPECT_TRUE(load_person(options().person).find("index")->mount);
}

// A table tells one scale for all of a finger, presses three: the tracked body is found anew.
TEST_F(FittedDevice, WhereTheTrackedBodySitsFollowsTheFingerFound) {
  const Pose X_BodyFt{exp_rotation({0.2, 1.3, -0.4}), {3 * mm, 1 * mm, -14 * mm}};
  DeviceFitOptions registered = options();
  registered.wearer =
      sized("slender.toml", {.length = 27 * mm, .breadth = 15 * mm, .depth = 13 * mm});
  const auto captures = captures_of(*FingerModel::load(*registered.wearer), X_BodyFt, 50 * mm);
  const RegistrationTask task{
      .finger = "index", .model = options().finger, .measured = {}, .table_height = 50 * mm};
  const auto lies = [&](double table_height) {
    Person person = load_person_if_any(options().person);
    (void)register_person(person, task, captures);
    person.at("index").size = {};  // or it would be the estimate's prior
    person.at("index").on_table->height = table_height;
    save_person(person);
  };
  lies(50 * mm);
  const Pose before = *load_person(options().person).find("index")->X_BodyFt;
  const DeviceFit fit = fit_device(registered, stop_);
  ASSERT_EQ(fit.failure, "");
  ASSERT_TRUE(fit.registration);
  const Pose after = *load_person(options().person).find("index")->X_BodyFt;
  EXPECT_LT((after.translation - fit.registration->X_BodyFt.translation).norm(), 1e-8);
  EXPECT_NEAR((after.translation - before.translation).norm(), fit.registration_moved, 1e-8);
  const double error = (before.translation - X_BodyFt.translation).norm();
  EXPECT_GT(error, 0.2 * mm);
  EXPECT_LT((after.translation - X_BodyFt.translation).norm(), 0.6 * error);
  EXPECT_LT(fit.registration->height_residual, 0.5 * mm);

  // A table that was somewhere else: the finger is learned, the body stays.
  std::filesystem::remove(options().person);
  lies(60 * mm);
  const DeviceFit elsewhere = fit_device(registered, stop_);
  EXPECT_EQ(elsewhere.failure, "");
  EXPECT_FALSE(elsewhere.registration);
  EXPECT_THAT(elsewhere.registration_failure, HasSubstr("off the table"));
  const Person person = load_person(options().person);
  EXPECT_TRUE(person.find("index")->mount);
  EXPECT_LT((person.find("index")->X_BodyFt->translation - before.translation).norm(), 1e-8);
}

TEST_F(FittedDevice, ByTouchAsksNoSensor) {
  DeviceFitOptions by_touch = options_by_touch();
  by_touch.fault = ForceSensorFault::kDead;
  EXPECT_THROW((void)fit_device(by_touch, stop_), InputError);
  by_touch = options_by_touch();
  by_touch.sensor_noise = 0.02;
  EXPECT_THROW((void)fit_device(by_touch, stop_), InputError);
  EXPECT_FALSE(is_written());
}

// Without a force sensor: not how stiff the skin is, but where it is.
TEST_F(FittedDevice, LearnsByTouchesThatTheWearerTells) {
  DeviceFitOptions by_touch = options_by_touch();
  const DeviceFit fit = fit_device(by_touch, stop_);
  ASSERT_EQ(fit.failure, "");
  EXPECT_EQ(fit.presses, 10);
  EXPECT_LE(fit.duration, 60.0);
  EXPECT_LT(fit.apart, 0.2e-3);
  EXPECT_LT(fit.greatest_force, 0.3);
  EXPECT_GT(fit.greatest_force, kFeltForce);
  EXPECT_LT(fit.estimate.touch_deviation, 0.15e-3);
  EXPECT_GT(fit.estimate.touch_deviation, 0.0);
  EXPECT_FALSE(fit.estimate.is_told(WearerTrait::kModulus));
  EXPECT_TRUE(fit.estimate.is_told(WearerTrait::kMountZ));
  // It says itself that a force sensor would do better.
  EXPECT_GT(fit.estimate.predicted_force_error, 0.2);
  EXPECT_LT(fit.estimate.predicted_force_error, 0.5 * fit.estimate.known_force_error);
  EXPECT_GT(force_error(by_touch, false), 0.4);
  EXPECT_LT(force_error(by_touch, true), 0.25);
}

TEST_F(FittedDevice, WhoTellsTouchesAnyHowLearnsNothing) {
  DeviceFitOptions by_touch = options_by_touch();
  by_touch.wear.reaction = 0.5;
  by_touch.wear.reaction_spread = 0.3;
  by_touch.seed = 2;  // a third of all seeds tell the last touch as far from the first
  expect_refused(by_touch, "the same touch was told");
}

TEST_F(FittedDevice, WhoNeverTellsIsLeftAlone) {
  DeviceFitOptions by_touch = options_by_touch();
  by_touch.wear.reaction = 100.0;
  expect_refused(by_touch, "no touch was told within 1.2 mm");
}

TEST_F(FittedDevice, PutOnAgainTheMountAloneIsLookedFor) {
  DeviceFitOptions again = options();
  again.again = true;
  EXPECT_THROW((void)fit_device(again, stop_), InputError) << "nothing is known yet";
  ASSERT_FALSE(first_fit().text.empty());
  std::ofstream(again.person) << first_fit().text;
  const PersonFinger before = *load_person(again.person).find("index");
  const DeviceFit fit = fit_device(again, stop_);
  ASSERT_EQ(fit.failure, "");
  EXPECT_EQ(fit.presses, 5);
  EXPECT_LE(fit.duration, 10.0);
  const PersonFinger after = *load_person(again.person).find("index");
  EXPECT_NEAR(*after.size.depth, *before.size.depth, 1e-8);
  EXPECT_NEAR(*after.modulus_factor, *before.modulus_factor, 1e-5);
  EXPECT_NEAR(after.mount->translation.z(), before.mount->translation.z(), 0.2 * mm);
}

TEST_F(FittedDevice, AStopWhileItEstimatesEndsItAndNothingIsWritten) {
  StopSignals signals;
  for (const bool by_signal : {true, false}) {
    stop_ = false;
    bool estimated = false;
    DeviceFitOptions options = this->options();
    options.stop_signals = &signals;
    options.watch = [&](const DeviceFitMoment& now) {
      if (!now.estimating) return;
      estimated = true;
      if (by_signal) {
        signals.stops.fetch_add(1);
      } else {
        stop_ = true;
      }
    };
    const DeviceFit fit = fit_device(options, stop_);
    EXPECT_TRUE(estimated);
    EXPECT_EQ(fit.presses, 9);
    EXPECT_THAT(fit.failure, HasSubstr("ended before"));
    EXPECT_FALSE(is_written());
  }
}

// A device that no run would let this wearer wear is told now, not by the next command.
TEST_F(FittedDevice, AFingerThatTheDeviceRestsOnAtHomeIsRefused) {
  std::string text = read_text_file(kFitProject / "devices" / "thimble-3rrs.toml", 10000);
  const std::string clearance = "clearance_mm = 3.0";
  ASSERT_NE(text.find(clearance), std::string::npos);
  text.replace(text.find(clearance), clearance.size(), "clearance_mm = 0.1");
  DeviceFitOptions close = options();
  close.device = directory_ / "close.toml";
  std::ofstream(close.device) << text;
  const FingerSize size = finger_size(*FingerModel::load(close.finger));
  close.wearer = sized("thick.toml", {.depth = 1.03 * *size.depth});
  expect_refused(close, "cannot be worn");
}

TEST_F(FittedDevice, ASensorScaledToNothingIsDead) {
  std::string text = read_text_file(options().device, 100000);
  DeviceFitOptions dead = options();
  dead.device = directory_ / "device.toml";
  dead.sensor.reset();
  dead.sensor_noise.reset();
  std::ofstream(dead.device) << text << "\n[force_sensor]\nkind = \"emulator\"\nscale_N = 0.0\n";
  expect_refused(dead, "dead");
  std::ofstream(dead.device) << text << "\n[force_sensor]\nkind = \"emulator\"\nscale_N = -1.0\n";
  expect_refused(dead, "reversed");
  std::ofstream(dead.device) << text << "\n[force_sensor]\nkind = \"udp\"\nrate_Hz = 10.0\n";
  dead.real_time = true;
  expect_refused(dead, "too slow");
}

TEST_F(FittedDevice, AFaultOnTheWayIsNamedAndNothingIsWritten) {
  DeviceFitOptions faulty = options();
  faulty.fault_at = 2.5;
  for (const auto& [fault, word] :
       {std::pair{ForceSensorFault::kStuck, "stuck"},
        std::pair{ForceSensorFault::kSilent, "said nothing"},
        std::pair{ForceSensorFault::kReversed, ""}, std::pair{ForceSensorFault::kDead, ""}}) {
    faulty.fault = fault;
    expect_refused(faulty, word);
  }
  faulty.fault = ForceSensorFault::kNoisy;
  faulty.fault_at = 0.0;
  expect_refused(faulty, "too noisy");
}

TEST_F(FittedDevice, WithoutASensorItIsRefusedByName) {
  DeviceFitOptions without = options();
  without.sensor.reset();
  try {
    (void)fit_device(without, stop_);
    FAIL() << "fitted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("force_sensor"));
  }
}

TEST_F(FittedDevice, WhatDoesNotTiltTellsTooLittle) {
  DeviceFitOptions one = options();
  one.device = kFitProject / "devices" / "disk-linear.toml";
  const DeviceFit fit = fit_device(one, stop_);
  EXPECT_EQ(fit.presses, 1);
  EXPECT_NE(fit.failure, "");
  EXPECT_FALSE(is_written());
}

TEST_F(FittedDevice, LimitsThatForbidTheTiltsPressNobody) {
  std::string text = read_text_file(options().device, 100000);
  const std::string limit = "max_tilt_deg = 30.0";
  text.replace(text.find(limit), limit.size(), "max_tilt_deg = 10.0");
  DeviceFitOptions narrow = options();
  narrow.device = directory_ / "device.toml";
  std::ofstream(narrow.device) << text;
  try {
    (void)fit_device(narrow, stop_);
    FAIL() << "fitted";
  } catch (const OperationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("15 degrees"));
  }
  EXPECT_FALSE(is_written());
}

/// By the clock, through bus emulator, guard process and a wire, and given up on the way.
class FittedInRealTime : public FittedDevice {
 protected:
  DeviceFit fit_until(double seconds, DeviceFitOptions options,
                      const std::function<void()>& interrupt) {
    std::atomic<bool> began{false};
    std::atomic<bool> ended{false};
    options.watch = [&began](const DeviceFitMoment&) { began = true; };
    std::thread later([&] {
      // A busy machine takes its time to get that far.
      while (!began && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      interrupt();
    });
    options.real_time = true;
    DeviceFit fit = fit_device(options, stop_);
    ended = true;
    later.join();
    return fit;
  }
};

TEST_F(FittedInRealTime, CtrlCRetractsAndWritesNothing) {
  DeviceFitOptions options = this->options();
  options.sensor = ForceSensorKind::kSerial;
  const DeviceFit fit = fit_until(2.5, options, [this] { stop_ = true; });
  EXPECT_THAT(fit.failure, HasSubstr("ended before"));
  EXPECT_LT(fit.duration, 4.0);
  EXPECT_FALSE(is_written());
}

TEST_F(FittedInRealTime, AStopEndsIt) {
  DeviceFitOptions options = this->options();
  options.device = kFitProject / "devices" / "thimble-3rrs-feetech.toml";
  options.sensor = ForceSensorKind::kOsc;
  StopSignals signals;
  options.stop_signals = &signals;
  const DeviceFit fit = fit_until(2.5, options, [&] { signals.stops.fetch_add(1); });
  EXPECT_THAT(fit.failure, HasSubstr("stop"));
  EXPECT_FALSE(is_written());
}

}  // namespace
}  // namespace softfinger
