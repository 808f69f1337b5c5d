#include "pose_sender.hpp"

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"

namespace softfinger {
namespace {

constexpr double kRate = 120.0;  // Hz

}  // namespace

Pose soaked_finger(double time) {
  constexpr double kRound = 2.0 * std::numbers::pi * 0.5;
  constexpr double kDown = 2.0 * std::numbers::pi * 0.7;
  return {exp_rotation({0.0, 6.0 * deg, 0.0}),
          {(-3.0 + 3.0 * std::sin(kRound * time)) * mm, 2.0 * std::cos(kRound * time) * mm,
           (29.0 - 3.3 * std::sin(kDown * time)) * mm}};
}

PoseSender::PoseSender(std::uint16_t port, PoseTrouble trouble)
    : port_(port),
      trouble_(std::move(trouble)),
      socket_({kLoopback, 0}),
      thread_([this] { serve(); }) {}

PoseSender::~PoseSender() {
  ending_ = true;
  thread_.join();
}

void PoseSender::serve() {
  std::mt19937_64 random(3);
  const auto happens = [&](double probability) {
    return static_cast<double>(random() >> 11) * 0x1p-53 < probability;
  };
  std::vector<PoseDatagram> held_back;
  const auto send = [&](const PoseDatagram& datagram) {
    socket_.send({kLoopback, port_}, datagram);
  };
  const double began = monotonic_time();
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t number = 1; !ending_; ++number) {
    const double time = monotonic_time() - began;
    Pose X_WFt = soaked_finger(time);
    if (trouble_.jump) X_WFt.translation.x() += trouble_.jump(time, number);
    const double ahead = trouble_.clock_ahead ? trouble_.clock_ahead(time) : 0.0;
    const PoseDatagram datagram = encode_pose_datagram(
        {.X_WFt = X_WFt, .valid = true, .sequence = number, .time = 5000.0 + time + ahead});
    if (happens(trouble_.reordering)) {
      held_back.push_back(datagram);
    } else if (!happens(trouble_.loss)) {
      send(datagram);
      if (happens(trouble_.duplication)) send(datagram);
      for (const PoseDatagram& late : held_back) send(late);
      held_back.clear();
    }
    std::this_thread::sleep_until(
        start + std::chrono::duration_cast<std::chrono::nanoseconds>(
                    std::chrono::duration<double>(static_cast<double>(number) / kRate)));
  }
}

}  // namespace softfinger
