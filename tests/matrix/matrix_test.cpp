// Fingers with devices: does the wearer feel what the virtual finger touches, when it does and only
// then, and never more than the device's limits allow?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include "../support/temporary_directory.hpp"
#include "matrix_case.hpp"
#include "softfinger/actuation/force_ceiling.hpp"
#include "softfinger/actuation/force_limiter.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

/// SOFTFINGER_MATRIX=all: the whole of it; else so many.
constexpr std::size_t kDrawn = 7;
constexpr double kExplored = 3.0;  // s of a scene
constexpr std::uint64_t kSeed = 20151;
constexpr double kTouch = 0.02;      // N; less is a graze
constexpr double kSureTouch = 0.08;  // N; less may rest on skin that the device cannot reach
constexpr double kSmaller = 0.96;    // of the model's sizes
constexpr double kNearLimit = 0.35;  // of it, some wearer feels where a device is held back
constexpr double kLeastForce = 0.9, kMostForce = 1.2;  // of the virtual, where it is matched
constexpr int kEarly = 1, kLate = 2;                   // ticks

std::uint64_t seed() {
  const char* given = std::getenv("SOFTFINGER_MATRIX_SEED");
  return given != nullptr ? std::stoull(given) : kSeed;
}

/// SOFTFINGER_MATRIX_VERBOSE=1 prints each case with its number, =ticks what was felt as well; the
/// one of number k alone is SOFTFINGER_MATRIX_PART=(k + 1)/1000 of all.
std::string verbose() {
  const char* given = std::getenv("SOFTFINGER_MATRIX_VERBOSE");
  return given != nullptr ? given : "";
}

/// A tip's table of force limits, the more so of a finer mesh, and stress of many pins.
bool takes_long(const MatrixCase& one) {
  return one.device == "delta-schorr" || one.device == "five-bar" ||
         one.finger == "index-layered" || one.objective == "stress";
}

/// What no draw had and use found: part of every run. The plate turned on and on about its own
/// axis.
const std::vector<MatrixCase> kFoundByUse{{.finger = "index",
                                           .device = "plate-6dof",
                                           .objective = "surface_and_force",
                                           .scene = "sphere"}};

struct Frame {
  double virtual_force = 0.0;  // N
  double model = 0.0, stiff = 0.0, small = 0.0, rough = 0.0;
  double left = 0.0;  // N, that pins which bear force would add at the ends of their strokes
  bool force_limited = false, rate_limited = false;
  Configuration q;
  JointAngles joints;
};

struct Wearers {
  Wearers(const std::shared_ptr<const FingerModel>& finger,
          const std::shared_ptr<const Device>& device)
      : model(finger, device),
        stiff(stiffest_wearer(*finger), device),
        small(smaller(*finger), device),
        rough(finger, device) {}

  static std::shared_ptr<const FingerModel> smaller(const FingerModel& finger) {
    auto wearer = std::make_shared<FingerModel>(finger);
    const FingerSize size = finger_size(finger);
    resize(*wearer, {.length = *size.length * kSmaller,
                     .breadth = *size.breadth * kSmaller,
                     .depth = *size.depth * kSmaller});
    return wearer;
  }

  Twin model, stiff, small, rough;
};

class Matrix : public testing::Test {
 protected:
  void run(const MatrixCase& one) {
    const TemporaryDirectory folder;
    RunOptions options;
    options.scene = write_scene(one, folder / "");
    options.as_fast_as_possible = true;
    if (!one.scene.empty()) options.duration = kExplored;
    options.actuator.port = "emulator";
    options.objective = objective_kind(one.objective);
    const auto setup = load_setup(options);
    device_ = setup->devices.front();
    Wearers wearers(setup->models.front(), device_);
    for (const Configuration& q : {device_->home(), device_->retracted()}) {
      wearers.model.reset();
      wearers.model.press(q, 0.5, 0.0);
      EXPECT_EQ(wearers.model.contact().normal_force, 0.0) << "presses while it rests";
    }
    wearers.model.reset();
    relaxes_ = !setup->models.front()->relaxation.terms.empty();
    frames_.clear();
    unconverged_ = 0;
    double before = 0.0;
    SceneRun::Hooks hooks;
    hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
      const FingerLoop& loop = chain.loop();
      const TickRecord& tick = chain.device().record();
      const double friction = loop.contact().friction_coefficient;
      const double elapsed = std::max(0.0, tick.time - before);
      before = tick.time;
      const auto feels = [&](Twin& twin, double mu) {
        if (!twin.press(tick.command.configuration, mu, elapsed).converged) ++unconverged_;
        return twin.contact().normal_force;
      };
      Frame frame;
      frame.virtual_force = loop.contact().normal_force;
      frame.model = feels(wearers.model, friction);
      if (device_->pin_field() != nullptr) {
        frame.left = force_left(wearers.model, tick.command.configuration);
      }
      if (device_->settings().max_force > 0.0) {
        frame.stiff = feels(wearers.stiff, friction);
        frame.small = feels(wearers.small, friction);
        frame.rough = feels(wearers.rough, kMostFriction);
      }
      frame.force_limited = tick.command.force_limited;
      frame.rate_limited = tick.command.rate_limited;
      frame.q = tick.command.configuration;
      frame.joints = tick.command.joints;
      frames_.push_back(frame);
      if (verbose() == "ticks") print(frame, tick, loop.contact());
    };
    const std::atomic<bool> stop{false};
    run_headless(setup, options, stop, {}, std::move(hooks));
  }

  /// To first order.
  [[nodiscard]] double force_left(Twin& twin, const Configuration& q) const {
    Vector3 force;
    SurfaceJacobian by_q;
    if (!twin.force_and_derivative(force, by_q) || force.isZero()) return 0.0;
    double left = 0.0;
    for (int k = 0; k < device_->degrees_of_freedom(); ++k) {
      const double per_metre = std::max(0.0, by_q.col(k).dot(force.normalized()));
      left += per_metre * (device_->axes()[static_cast<std::size_t>(k)].max - q[k]);
    }
    return left;
  }

  void print(const Frame& frame, const TickRecord& tick, const ContactSet& contact) const {
    const auto& axes = device_->axes();
    std::cerr << fmt::format(
        "{} {:.3f} s: virtual {:.4f} N on {} samples, model {:.4f}, stiff {:.3f}, small {:.3f}, "
        "rough {:.3f};{}{}",
        frames_.size() - 1, tick.time, frame.virtual_force, contact.contact_count, frame.model,
        frame.stiff, frame.small, frame.rough,
        fmt::format("{}{}", frame.force_limited ? " force limited;" : "",
                    frame.rate_limited ? " rate limited;" : ""),
        at_limit(frame.q) ? " at its limit;" : "");
    for (std::size_t k = 0; k < std::min<std::size_t>(axes.size(), 8); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      std::cerr << fmt::format(" {} {:.3f} ({:.3f})", axes[k].name, frame.q[i] / axes[k].unit(),
                               tick.wanted[i] / axes[k].unit());
    }
    std::cerr << "\n";
  }

  /// The virtual finger touched with that much in every one, or any, of these ticks.
  template <typename Holds>
  [[nodiscard]] bool any(std::ptrdiff_t first, std::ptrdiff_t last, const Holds& holds) const {
    const auto end = static_cast<std::ptrdiff_t>(frames_.size()) - 1;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, first); k <= std::min(last, end); ++k) {
      if (holds(frames_[static_cast<std::size_t>(k)])) return true;
    }
    return false;
  }

  void check_touch() const {
    int touched = 0;
    int missed = 0;
    int false_touch = 0;
    bool under_way = false;
    double period = 1.0 / device_rate(*device_);
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(frames_.size()); ++k) {
      const Frame& frame = frames_[static_cast<std::size_t>(k)];
      const bool sure = k >= kLate && !any(k - kLate, k, [](const Frame& f) {
                          return f.virtual_force < kSureTouch;
                        });
      // Motors that have run at their most since the touch cannot have been there sooner.
      under_way =
          frame.virtual_force > 0.0 && frame.rate_limited &&
          (under_way || k == 0 || frames_[static_cast<std::size_t>(k - 1)].virtual_force <= 0.0);
      if (sure) {
        ++touched;
        if (frame.model <= 0.0 && !under_way) ++missed;
      }
      const bool near_touch =
          any(k - kLate, k + kEarly, [](const Frame& f) { return f.virtual_force > 0.0; });
      if (!near_touch && frame.model > kTouch) ++false_touch;
    }
    EXPECT_GT(touched, 3) << "the virtual finger hardly touches: nothing is compared";
    EXPECT_EQ(missed, 0) << "of " << touched << " ticks, each " << period << " s";
    EXPECT_EQ(false_touch, 0);
  }

  void check_limits() const {
    const double most = device_->settings().max_force;
    const JointLimits& limits = device_->joint_limits();
    const double step = limits.max_rate / device_rate(*device_) * (1.0 + 1e-9) + 1e-12;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const Frame& frame = frames_[k];
      if (most > 0.0) {
        for (const double force : {frame.model, frame.stiff, frame.small, frame.rough}) {
          EXPECT_LE(force, most) << "tick " << k
                                 << fmt::format(": {:.2f} {:.2f} {:.2f} {:.2f}", frame.model,
                                                frame.stiff, frame.small, frame.rough);
        }
      }
      ASSERT_TRUE(device_->reachable(frame.q)) << "tick " << k;
      EXPECT_GE((frame.joints - limits.min).minCoeff(), -1e-9);
      EXPECT_LE((frame.joints - limits.max).maxCoeff(), 1e-9);
      if (k == 0) continue;
      EXPECT_LE((frame.joints - frames_[k - 1].joints).cwiseAbs().maxCoeff(), step);
    }
  }

  /// Where force is matched and has stood for some ticks, it arrives, unless a limit holds the
  /// device back that is told, or the device is at the end of its way.
  void check_force() const {
    int compared = 0;
    double least = 1.0;
    double most = 1.0;
    for (std::size_t k = 6; k < frames_.size(); ++k) {
      const Frame& frame = frames_[k];
      bool steady = frame.virtual_force > 0.15;
      bool held = at_limit(frame.q);
      for (std::size_t back = 1; back <= 6; ++back) {
        const double then = frames_[k - back].virtual_force;
        steady = steady && std::abs(then - frame.virtual_force) < 0.1 * frame.virtual_force;
        held = held || frames_[k - back].force_limited;
      }
      if (steady && frame.force_limited && !relaxes_) {
        // Nobody is held back from a force that is far from the limit. Of skin that relaxes limits
        // see what it bears before it has.
        EXPECT_GT(std::max({frame.model, frame.stiff, frame.small, frame.rough}),
                  kNearLimit * device_->settings().max_force)
            << "tick " << k << " is said to be limited";
      }
      if (!steady || held || frame.force_limited) continue;
      ++compared;
      // Pins that have no stroke left bring what they can.
      const double allowed = device_->pin_field() == nullptr
                                 ? frame.virtual_force
                                 : std::min(frame.virtual_force, frame.model + frame.left);
      const double part = frame.model / allowed;
      least = std::min(least, part);
      most = std::max(most, part);
      EXPECT_GE(part, kLeastForce) << "tick " << k;
      EXPECT_LE(frame.model, kMostForce * frame.virtual_force) << "tick " << k;
    }
    compared_forces += compared;
    if (!verbose().empty()) {
      std::cerr << fmt::format("  {} ticks' forces, {:.3f} to {:.3f} of what was wanted\n",
                               compared, least, most);
    }
  }

  /// Of pins one or another is at the end of its stroke always; the others make up for it.
  [[nodiscard]] bool at_limit(const Configuration& q) const {
    if (device_->pin_field() != nullptr) return false;
    Configuration ahead = q;
    device_->advance(0.02 * mm, ahead);
    return !device_->reachable(ahead);
  }

  std::shared_ptr<const Device> device_;
  std::vector<Frame> frames_;
  bool relaxes_ = false;
  int unconverged_ = 0;
  static inline int compared_forces = 0;
};

TEST_F(Matrix, TheWearerFeelsWhatIsTouchedAndNothingElse) {
  std::vector<MatrixCase> cases = matrix_cases(seed());
  const char* which = std::getenv("SOFTFINGER_MATRIX");
  const bool all = which != nullptr && std::string(which) == "all";
  if (!all) {
    std::erase_if(cases, takes_long);
    cases.resize(std::min(cases.size(), kDrawn));
  }
  bool force_wanted = false;
  cases.insert(cases.begin(), kFoundByUse.begin(), kFoundByUse.end());
  std::size_t part = 0;
  std::size_t parts = 1;
  if (const char* given = std::getenv("SOFTFINGER_MATRIX_PART")) {  // "1/2"
    const std::string text = given;
    part = std::stoul(text) - 1;
    parts = std::stoul(text.substr(text.find('/') + 1));
  }
  for (std::size_t k = part; k < cases.size(); k += parts) {
    SCOPED_TRACE(testing::Message() << cases[k]);
    if (!verbose().empty()) std::cerr << k << " " << cases[k] << "\n";
    run(cases[k]);
    EXPECT_EQ(unconverged_, 0);
    check_touch();
    check_limits();
    if (cases[k].objective == "surface_and_force") {
      check_force();
      force_wanted = true;
    }
  }
  if (force_wanted) {
    EXPECT_GT(compared_forces, 0);
  }
}

}  // namespace
}  // namespace softfinger
