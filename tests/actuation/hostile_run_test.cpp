// What really goes over the line of a live run, hostile input and stalls included: every byte is
// decoded and every command held against the limits. Nobody answers on this line.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;

/// The other end of a serial line; keeps the set-target commands that arrive, in order.
class Listener {
 public:
  Listener() : near_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(::grantpt(near_), 0);
    EXPECT_EQ(::unlockpt(near_), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(near_, name.data(), name.size()), 0);
    port_ = name.data();
    thread_ = std::thread([this] { listen(); });
  }
  ~Listener() { finish(); }
  /// Reads what is left and stops.
  void finish() {
    if (!thread_.joinable()) return;
    stop_ = true;
    thread_.join();
    ::close(near_);
  }

  [[nodiscard]] const std::string& port() const { return port_; }
  // After finish().
  [[nodiscard]] const std::vector<MaestroRequest>& targets() const { return targets_; }
  [[nodiscard]] const MaestroDecoder& decoder() const { return decoder_; }

 private:
  void listen() {
    std::array<std::uint8_t, 256> bytes;
    while (true) {
      pollfd line{.fd = near_, .events = POLLIN, .revents = 0};
      ::poll(&line, 1, 20);
      if ((line.revents & POLLIN) == 0) {
        if (stop_) return;
        if (line.revents != 0) std::this_thread::sleep_for(milliseconds(5));
        continue;
      }
      const auto got = ::read(near_, bytes.data(), bytes.size());
      for (std::size_t i = 0; got > 0 && i < static_cast<std::size_t>(got); ++i) {
        const auto request = decoder_.push(bytes[i]);
        if (request && request->command == MaestroCommand::kSetTarget) targets_.push_back(*request);
      }
    }
  }

  int near_;
  std::string port_;
  std::atomic<bool> stop_{false};
  MaestroDecoder decoder_;
  std::vector<MaestroRequest> targets_;
  std::thread thread_;
};

TEST(Wire, EveryByteOfAHostileLiveRunIsWithinLimits) {
  constexpr double kRate = 200.0;  // faster than usual, for more commands in the same time
  const auto device = lever_platform({.rate = kRate});
  Listener listener;
  std::uint64_t sent = 0;
  {
    Actuator actuator(device, {.port = listener.port()});
    std::mt19937_64 random(23);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double hostile[] = {std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(), 1e30, -1e300};
    double time = 0.0;
    for (int k = 0; k < 500; ++k) {
      WantedMotion wanted{.configuration = Configuration(3), .tracked = k % 100 < 70};
      for (int i = 0; i < 3; ++i) wanted.configuration[i] = uniform(random);
      wanted.configuration[2] *= 0.02;
      if (k % 3 == 0) {
        wanted.configuration[static_cast<int>(random() % 3)] = hostile[random() % 4];
      }
      actuator.command(wanted, time);
      time += k % 7 == 0 ? 0.5 : 1.0 / kRate;
      // Bursts, pauses and stalls.
      const int pause = k % 120 == 119 ? 250 : static_cast<int>(random() % 9);
      std::this_thread::sleep_for(milliseconds(pause));
    }
    actuator.finish();
    sent = actuator.commands_sent();
  }
  listener.finish();

  EXPECT_EQ(listener.decoder().malformed_bytes(), 0u);
  ASSERT_EQ(listener.targets().size(), 3 * sent);
  EXPECT_GT(sent, 300u);
  const JointLimits& limits = device->joint_limits();
  JointAngles last;
  JointAngles joints(3);
  Configuration q;
  for (std::size_t k = 0; k < sent; ++k) {
    for (int i = 0; i < 3; ++i) {
      const ServoMap map(device->settings().transport->servos[static_cast<std::size_t>(i)]);
      const MaestroRequest& request = listener.targets()[3 * k + static_cast<std::size_t>(i)];
      ASSERT_EQ(request.channel, map.channel());
      joints[i] = map.joint_of_target(request.values[0]);
      ASSERT_GE(joints[i], limits.min[i] - 1e-7);
      ASSERT_LE(joints[i], limits.max[i] + 1e-7);
    }
    if (k > 0) {
      ASSERT_LE((joints - last).cwiseAbs().maxCoeff(), limits.max_rate / kRate + 1e-9) << k;
    }
    ASSERT_TRUE(device->forward_kinematics(joints, q));
    ASSERT_LE(std::hypot(q[0], q[1]), LeverPlatform::kMaxTilt + 1e-9);
    last = joints;
  }
  // The run ended retracted.
  EXPECT_LT(std::abs(q[2] - device->retracted()[2]), 0.05 * mm);
}

}  // namespace
}  // namespace softfinger
