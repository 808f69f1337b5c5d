// A registration asked for from the page: poses over the network, the file, the device that stays
// away, and the run that goes on with what was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/table_rest.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {
namespace {

using Phase = RegistrationState::Phase;
constexpr auto kPatience = std::chrono::seconds(60);

/// A body on a finger like the model's, held in each posture on a table at z = 50 mm.
class HeldBody {
 public:
  HeldBody()
      : model_(
            FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index.toml")) {}

  [[nodiscard]] Pose pose(Posture posture) const {
    return lying(*model_, posture, 50 * mm) * X_BodyFt.inverse();
  }

  const Pose X_BodyFt{exp_rotation({0.2, 1.3, -0.4}), {3 * mm, 1 * mm, -14 * mm}};

 private:
  std::shared_ptr<const FingerModel> model_;
};

/// A live run over UDP and its viewer, which is this thread.
class RegisteringSession : public testing::Test {
 protected:
  RegisteringSession() {
    const std::uint16_t port = UdpSocket({kLoopback, 0}).local().port;
    RunOptions options;
    options.scene = scenes_.scene("sphere");
    options.trackers = {"udp:" + std::to_string(port)};
    options.actuator.port = "emulator";
    options.twin = false;
    options.person = person_;
    options.person_may_be_new = true;
    session_ = std::make_unique<LiveSession>(options, false);
    loop_ = std::thread([this] { session_->run(stop_); });
    sender_ = std::thread([this, port] {
      UdpSocket socket({kLoopback, 0});
      const auto began = std::chrono::steady_clock::now();
      for (std::uint32_t count = 1; !stop_; ++count) {
        const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
        const PoseDatagram datagram = encode_pose_datagram({.X_WFt = body_.pose(posture_.load()),
                                                            .valid = true,
                                                            .sequence = count,
                                                            .time = time.count()});
        socket.send({kLoopback, port}, datagram);
        std::this_thread::sleep_for(std::chrono::milliseconds(8));
      }
    });
  }
  ~RegisteringSession() override {
    stop_ = true;
    sender_.join();
    loop_.join();
  }

  void ask(LiveRequest::Kind kind) {
    LiveRequest request;
    request.kind = kind;
    request.generation = session_->latest().generation;
    request.stops = session_->latest().stops;
    session_->request(request);
  }
  [[nodiscard]] const RegistrationState& state() const { return session_->registration(); }
  /// Looks at the run until `reached`, always holding the posture asked for.
  template <typename Reached>
  bool watch(const Reached& reached) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!reached()) {
      if (std::chrono::steady_clock::now() > end) return false;
      session_->refresh();
      for (const PostureRow& posture : kPostures) {
        if (posture.name == state().wanted) posture_ = posture.value;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  bool device_is(const char* name) {
    return watch([&] { return session_->latest().fingers.at(0).device_state == name; });
  }

  const ScenesWithoutForceLimit scenes_;
  const TemporaryDirectory directory_;
  const std::filesystem::path person_ = directory_ / "anna.toml";
  const HeldBody body_;
  std::atomic<Posture> posture_{Posture::kPad};
  std::atomic<bool> stop_{false};
  std::unique_ptr<LiveSession> session_;
  std::thread loop_, sender_;
};

TEST_F(RegisteringSession, FindsTheBodyAndGoesOnWithItRetracted) {
  EXPECT_TRUE(session_->description()->fingers.at(0).registrable);
  ASSERT_TRUE(watch([&] { return session_->latest().fingers.at(0).tracked; }));
  ask(LiveRequest::Kind::kRegister);
  EXPECT_EQ(state().phase, Phase::kRunning);
  EXPECT_TRUE(device_is("retracting"));
  ask(LiveRequest::Kind::kRelease);  // not while the finger is on the table
  ASSERT_TRUE(watch([&] { return state().phase != Phase::kRunning; }));
  ASSERT_EQ(state().phase, Phase::kSaved) << state().message;
  const Person found = load_person(person_);
  ASSERT_NE(found.find("index"), nullptr);
  const Pose X_BodyFt = found.find("index")->X_BodyFt.value();
  EXPECT_LT((X_BodyFt.translation - body_.X_BodyFt.translation).norm(), 0.01 * mm);
  EXPECT_LT((X_BodyFt.rotation - body_.X_BodyFt.rotation).norm(), 1e-3);

  // The same run anew: the finger is where it lies, and the device away from it until released.
  ASSERT_TRUE(watch([&] { return session_->latest().generation == 2; }));
  ASSERT_TRUE(watch([&] {
    const Snapshot::Finger& finger = session_->latest().fingers.at(0);
    const Pose lies = body_.pose(Posture::kPad) * body_.X_BodyFt;
    return finger.tracked && (finger.X_WFt.translation - lies.translation).norm() < 0.02 * mm;
  }));
  EXPECT_TRUE(session_->latest().stopped.asked);
  EXPECT_TRUE(device_is("retracting"));
  EXPECT_TRUE(watch([&] {
    ask(LiveRequest::Kind::kRelease);
    return !session_->latest().stopped.asked;
  }));
}

TEST_F(RegisteringSession, CancelledNothingIsWritten) {
  ASSERT_TRUE(watch([&] { return session_->latest().fingers.at(0).tracked; }));
  ask(LiveRequest::Kind::kRegister);
  ASSERT_TRUE(watch([&] { return state().held == 2; }));
  ask(LiveRequest::Kind::kCancelRegistration);
  EXPECT_EQ(state().phase, Phase::kIdle);
  EXPECT_FALSE(std::filesystem::exists(person_));
  EXPECT_TRUE(watch([&] { return session_->latest().stopped.asked; }));
  LiveRequest absent;
  absent.kind = LiveRequest::Kind::kRegister;
  absent.finger = 7;
  session_->request(absent);
  EXPECT_EQ(state().phase, Phase::kIdle);
}

}  // namespace
}  // namespace softfinger
