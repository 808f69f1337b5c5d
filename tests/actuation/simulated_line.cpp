#include "simulated_line.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <thread>

#include "softfinger/actuation/servo_line.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

/// Ends what was written so far; no bus says these bytes.
constexpr std::array<std::uint8_t, 16> kFence = {0x01, 0x7e, 0x33, 0x5a, 0x1c, 0x66, 0x09, 0x72,
                                                 0x2d, 0x48, 0x13, 0x57, 0x6b, 0x04, 0x39, 0x11};
/// Bytes of a pseudo-terminal that do not come in this time (wall, ms) never do.
constexpr int kPatience_ms = 20'000;

LineClock::Duration of_seconds(double s) {
  return std::chrono::duration_cast<LineClock::Duration>(std::chrono::duration<double>(s));
}

std::vector<EmulatedServo> servos_of(const Device& device, const Configuration& q) {
  JointAngles joints;
  EXPECT_TRUE(device.inverse_kinematics(q, joints));
  std::vector<EmulatedServo> servos;
  for (const ServoSettings& settings : device.settings().transport->servos) {
    const double joint = joints[static_cast<Eigen::Index>(servos.size())];
    const double fastest = 1.25 * device.joint_limits().max_rate * std::abs(settings.per_radian);
    servos.push_back({.channel = settings.channel,
                      .initial_setpoint = ServoMap(settings).setpoint(joint),
                      .rate = fastest,
                      .step = settings.step});
  }
  return servos;
}

}  // namespace

Board board_at(const Device& device, const Configuration& q) {
  const std::string& kind = device.settings().transport->kind;
  const auto servos = servos_of(device, q);
  Board board;
  if (kind == "maestro") {
    auto maestro =
        std::make_unique<MaestroEmulator>(servos, maestro_board(*device.settings().transport));
    board.reset = [it = maestro.get()] { it->reset(); };
    board.commands = [it = maestro.get()] { return it->targets_set(); };
    board.target = [it = maestro.get(), servos](std::size_t i) -> std::int32_t {
      return it->target(servos[i].channel);
    };
    board.bus = std::move(maestro);
    return board;
  }
  std::unique_ptr<const ServoProtocol> protocol;
  if (kind == "dynamixel") protocol = std::make_unique<DynamixelProtocol>();
  if (kind == "feetech") protocol = std::make_unique<FeetechProtocol>();
  auto table = std::make_unique<ServoTableEmulator>(std::move(protocol), servos);
  board.reset = [it = table.get()] { it->reset(); };
  board.commands = [it = table.get()] { return it->commands(); };
  board.target = [it = table.get()](std::size_t i) { return it->goal(i); };
  board.bus = std::move(table);
  return board;
}

SimulatedLine::SimulatedLine(std::shared_ptr<const Device> device)
    : device_(std::move(device)),
      channel_(device_->home()),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  static int count = 0;
  name_ = std::filesystem::temp_directory_path() /
          ("softfinger-line-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
}

SimulatedLine::~SimulatedLine() {
  if (near_ >= 0) unplug();
  ::close(wake_);
}

void SimulatedLine::at(double time, std::function<void()> event) {
  events_.emplace(start_ + of_seconds(time), std::move(event));
}

void SimulatedLine::plug_in(Board& board) {
  near_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 64> name{};
  ASSERT_EQ(::grantpt(near_), 0);
  ASSERT_EQ(::unlockpt(near_), 0);
  ASSERT_EQ(::ptsname_r(near_, name.data(), name.size()), 0);
  far_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios attributes{};
  ASSERT_EQ(::tcgetattr(far_, &attributes), 0);
  ::cfmakeraw(&attributes);
  ::tcsetattr(far_, TCSANOW, &attributes);
  std::filesystem::remove(name_);  // of a killed process that had this number
  std::filesystem::create_symlink(name.data(), name_);
  board_ = &board;
  commands_ = board.commands();
}

void SimulatedLine::unplug() {
  std::filesystem::remove(name_);
  ::close(near_);
  ::close(far_);
  near_ = -1;
}

void SimulatedLine::run(double until) {
  at(until, [this] {
    channel_.ending = true;
    wake();
  });
  ServoLine line(device_, {.port = name_, .rate = 1.0 / period()}, channel_, wake_, loop, *this);
  // A thread of its own, since it takes the priority of those that serve ports.
  std::thread([&line] {
    (void)line.open();
    line.serve();
  }).join();
  if (near_ >= 0) sleep_for(std::chrono::seconds(1));  // for the servos to get there
}

double SimulatedLine::time() const { return std::chrono::duration<double>(now_ - start_).count(); }

double SimulatedLine::period() const { return 1.0 / device_->settings().transport->rate; }

JointAngles SimulatedLine::standing() const {
  const auto& servos = device_->settings().transport->servos;
  JointAngles joints(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    joints[static_cast<Eigen::Index>(i)] = ServoMap(servos[i]).joint(board_->bus->setpoint(i));
  }
  return joints;
}

std::optional<JointAngles> SimulatedLine::reported() {
  channel_.report.refresh();
  if (!channel_.report.latest().known) return std::nullopt;
  return channel_.report.latest().joints;
}

LineChannel::Sent SimulatedLine::said_to_be_sent() {
  channel_.sent.refresh();
  return channel_.sent.latest();
}

std::optional<CommandDelivery> SimulatedLine::delivered() {
  if (!channel_.delivery.refresh()) return std::nullopt;
  return channel_.delivery.latest();
}

void SimulatedLine::sleep_until(TimePoint due) noexcept {
  while (now_ < due) advance(due);
}

bool SimulatedLine::wait(std::span<pollfd> events, TimePoint due) noexcept {
  while (::poll(events.data(), events.size(), 0) <= 0) {
    if (now_ >= due) return false;
    advance(due);
  }
  return true;
}

void SimulatedLine::advance(TimePoint due) {
  settle();  // what has been written arrives now
  const TimePoint tick = start_ + of_seconds(static_cast<double>(ticks_) * period());
  TimePoint next = std::min(due, std::max(tick, now_));
  if (!events_.empty()) next = std::min(next, std::max(events_.begin()->first, now_));
  now_ = next;
  while (!events_.empty() && events_.begin()->first <= now_) {
    const auto event = events_.extract(events_.begin());
    event.mapped()();
  }
  if (tick <= now_) loop_tick();
}

void SimulatedLine::loop_tick() {
  ++ticks_;
  const auto q = wanted ? wanted(time()) : std::nullopt;
  if (!q || channel_.ending) return;
  LineChannel::Wanted& draft = channel_.wanted.draft();
  draft = {.q = *q,
           .state = touching ? DeviceState::kRendering : DeviceState::kReady,
           .number = ++submitted_};
  draft.seal = draft.seal_of_this();
  if (spoil) spoil(draft);
  channel_.wanted.publish();
  wake();
}

void SimulatedLine::wake() {
  const std::uint64_t one = 1;
  EXPECT_EQ(::write(wake_, &one, sizeof one), static_cast<ssize_t>(sizeof one));
}

void SimulatedLine::was_sent_before(const Configuration& q) {
  channel_.sent.draft().q = q;
  channel_.sent.draft().seal = channel_.sent.draft().seal_of_this();
  if (spoil_sent) spoil_sent(channel_.sent.draft());
  channel_.sent.publish();
  channel_.commands_sent = 1;
}

StopLatch::Number SimulatedLine::stop(StopCause cause) {
  const StopLatch::Number number = channel_.stop.stop(cause);
  wake();
  return number;
}

void SimulatedLine::ask_release(StopLatch::Number number) {
  if (channel_.stop.ask_release(number)) wake();
}

void SimulatedLine::settle() {
  if (board_ != nullptr) board_->bus->advance_to(time());
  if (near_ < 0) return;
  Bytes bytes = take_written();
  if (to_board && !bytes.empty()) to_board(bytes);
  board_->bus->receive(bytes);
  note_targets();
  Bytes answer(4096);
  answer.resize(board_->bus->take_replies(answer));
  if (from_board) from_board(answer);
  if (!answer.empty()) deliver(answer);
}

SimulatedLine::Bytes SimulatedLine::take_written() {
  EXPECT_EQ(::write(far_, kFence.data(), kFence.size()), static_cast<ssize_t>(kFence.size()));
  Bytes bytes;
  const auto fenced = [&] {
    return bytes.size() >= kFence.size() &&
           std::equal(kFence.begin(), kFence.end(), bytes.end() - std::ssize(kFence));
  };
  while (!fenced()) {
    pollfd line{.fd = near_, .events = POLLIN, .revents = 0};
    if (::poll(&line, 1, kPatience_ms) <= 0) {
      ADD_FAILURE() << "the pseudo-terminal keeps what was written";
      return {};
    }
    std::array<std::uint8_t, 512> some;
    const ssize_t got = ::read(near_, some.data(), some.size());
    bytes.insert(bytes.end(), some.begin(), some.begin() + std::max<ssize_t>(got, 0));
  }
  bytes.resize(bytes.size() - kFence.size());
  return bytes;
}

void SimulatedLine::deliver(const Bytes& bytes) {
  int before = 0;
  ::ioctl(far_, FIONREAD, &before);
  EXPECT_EQ(::write(near_, bytes.data(), bytes.size()), std::ssize(bytes));
  int waiting = 0;
  for (int i = 0; i < 50 * kPatience_ms && waiting < before + std::ssize(bytes); ++i) {
    std::this_thread::sleep_for(std::chrono::microseconds(20));
    ::ioctl(far_, FIONREAD, &waiting);
  }
  EXPECT_EQ(waiting, before + std::ssize(bytes));
}

void SimulatedLine::note_targets() {
  const std::uint64_t commands = board_->commands();
  if (commands == commands_) return;
  commands_ = commands;
  const auto& servos = device_->settings().transport->servos;
  Sent sent{time(), JointAngles(static_cast<Eigen::Index>(servos.size()))};
  for (std::size_t i = 0; i < servos.size(); ++i) {
    const std::int32_t target = board_->target(i);
    if (target == 0) return;
    sent.joints[static_cast<Eigen::Index>(i)] = ServoMap(servos[i]).joint_of_target(target);
  }
  sent_.push_back(std::move(sent));
}

}  // namespace softfinger
