#include "troubled_board.hpp"

#include <algorithm>
#include <utility>

#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

bool TroubledMaestro::cuts() {
  cut_before_ = cutting_ && !cut_before_ && random_() % 10 < 3;
  return cut_before_;
}

void TroubledMaestro::receive(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty() && reset_.exchange(false)) {
    const std::size_t middle = random_() % bytes.size();
    maestro_.receive(bytes.first(middle));
    maestro_.reset();
    bytes = bytes.subspan(middle);
  } else if (!bytes.empty() && cuts()) {
    bytes = bytes.first(random_() % bytes.size());
  }
  maestro_.receive(bytes);
}

std::size_t TroubledMaestro::take_replies(std::span<std::uint8_t> out) {
  const std::size_t size = maestro_.take_replies(out);
  return cutting_ && random_() % 10 < 3 ? size / 2 : size;
}

TroubledBoard::TroubledBoard(std::shared_ptr<const Device> device, std::filesystem::path name)
    : device_(std::move(device)), name_(std::move(name)) {
  JointAngles home;
  (void)device_->inverse_kinematics(device_->home(), home);
  maestro_ = std::make_unique<TroubledMaestro>(servos_at(home));
  plug_in();
}

TroubledBoard::~TroubledBoard() { pull(); }

std::vector<EmulatedServo> TroubledBoard::servos_at(const JointAngles& joints) const {
  std::vector<EmulatedServo> servos;
  for (const ServoSettings& settings : device_->settings().transport->servos) {
    const double rate = 1.25 * device_->joint_limits().max_rate * std::abs(settings.per_radian);
    servos.push_back({.channel = settings.channel,
                      .initial_setpoint = ServoMap(settings).setpoint(joints[std::ssize(servos)]),
                      .rate = rate,
                      .step = settings.step});
  }
  return servos;
}

void TroubledBoard::pull() {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  std::filesystem::remove(name_, ignored);
  terminal_.reset();
}

void TroubledBoard::plug_in() {
  const JointAngles joints = standing();
  const std::lock_guard lock(mutex_);
  // Its servos' time begins anew with the terminal's.
  maestro_ = std::make_unique<TroubledMaestro>(servos_at(joints));
  terminal_ = std::make_unique<EmulatorTerminal>(*maestro_);
  std::filesystem::create_symlink(terminal_->port(), name_);
}

JointAngles TroubledBoard::standing() const {
  const std::lock_guard lock(mutex_);
  const auto& servos = device_->settings().transport->servos;
  JointAngles joints(std::ssize(servos));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    joints[static_cast<Eigen::Index>(i)] = ServoMap(servos[i]).joint(maestro_->setpoint(i));
  }
  return joints;
}

}  // namespace softfinger
