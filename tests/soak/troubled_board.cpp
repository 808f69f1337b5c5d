#include "troubled_board.hpp"

#include <algorithm>
#include <utility>

#include "softfinger/motors/emulation/emulated_bus.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

bool TroubledMaestro::cuts() {
  cut_before_ = cutting_ && !cut_before_ && random_() % 10 < 3;
  return cut_before_;
}

void TroubledMaestro::take(std::span<const std::uint8_t> bytes) {
  const auto targets = [this] {
    std::vector<std::uint16_t> all;
    for (const EmulatedServo& servo : servos_) all.push_back(maestro_.target(servo.channel));
    return all;
  };
  const std::vector<std::uint16_t> before = targets();
  maestro_.receive(bytes);
  const std::vector<std::uint16_t> after = targets();
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    if (after[i] != before[i]) most_at_once_ = std::max(most_at_once_.load(), ++changes_[i]);
  }
}

void TroubledMaestro::receive(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty() && reset_.exchange(false)) {
    const std::size_t middle = random_() % bytes.size();
    take(bytes.first(middle));
    maestro_.reset();
    bytes = bytes.subspan(middle);
  } else if (!bytes.empty() && cuts()) {
    bytes = bytes.first(random_() % bytes.size());
  }
  take(bytes);
}

std::size_t TroubledMaestro::take_replies(std::span<std::uint8_t> out) {
  const std::size_t size = maestro_.take_replies(out);
  return cutting_ && random_() % 10 < 3 ? size / 2 : size;
}

TroubledBoard::TroubledBoard(std::shared_ptr<const Device> device, std::filesystem::path name)
    : device_(std::move(device)), name_(std::move(name)) {
  JointAngles home;
  (void)device_->inverse_kinematics(device_->home(), home);
  cut_off_.resize(device_->settings().transport->servos.size());
  bus_ = bus_at(home);
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

std::unique_ptr<BusEmulator> TroubledBoard::bus_at(const JointAngles& joints) const {
  const TransportSettings& transport = *device_->settings().transport;
  if (transport.kind == "maestro") return std::make_unique<TroubledMaestro>(servos_at(joints));
  return make_bus_emulator(transport, servos_at(joints));
}

void TroubledBoard::cut_off(std::size_t servo) {
  const std::lock_guard lock(mutex_);
  dynamic_cast<ServoTableEmulator&>(*bus_).cut_off(servo);
  cut_off_[servo] = true;
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
  bus_ = bus_at(joints);
  line_ = std::make_unique<HoldingLine>(*bus_);
  terminal_ = std::make_unique<EmulatorTerminal>(*line_);
  std::filesystem::create_symlink(terminal_->port(), name_);
}

JointAngles TroubledBoard::standing() const {
  const std::lock_guard lock(mutex_);
  const auto& servos = device_->settings().transport->servos;
  JointAngles joints(std::ssize(servos));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    joints[static_cast<Eigen::Index>(i)] = ServoMap(servos[i]).joint(bus_->setpoint(i));
  }
  return joints;
}

double TroubledBoard::away_from(const JointAngles& standing, const JointAngles& joints) const {
  const std::lock_guard lock(mutex_);
  double farthest = 0.0;
  for (Eigen::Index i = 0; i < joints.size(); ++i) {
    if (cut_off_[static_cast<std::size_t>(i)]) continue;
    farthest = std::max(farthest, std::abs(standing[i] - joints[i]));
  }
  return farthest;
}

bool TroubledBoard::presses() const {
  Configuration q;
  if (!device_->forward_kinematics(standing(), q)) return false;
  const Eigen::Index travel = device_->approach_axis();
  return q[travel] > device_->home()[travel] + device_->settings().matching.approach;
}

}  // namespace softfinger
