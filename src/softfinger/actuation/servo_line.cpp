#include "softfinger/actuation/servo_line.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/thread_priority.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAttemptEvery{300};  ///< to open a port that is not there
constexpr milliseconds kAnswerTime{60};     ///< for the positions after opening

std::chrono::steady_clock::duration seconds(double s) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(s));
}

double to_seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

ServoLine::ServoLine(std::shared_ptr<const Device> device, std::unique_ptr<ServoBus> bus,
                     Options options)
    : device_(std::move(device)),
      options_(std::move(options)),
      period_(seconds(1.0 / options_.rate)),
      bus_(std::move(bus)),
      guard_(device_, device_->settings().transport->servos, options_.ceiling),
      wanted_(Wanted{device_->home(), DeviceState::kHoming}),
      report_(Report{device_->home(), false}),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (wake_ < 0) throw OperationError("the system has no more event descriptors");
}

ServoLine::~ServoLine() {
  finish();
  ::close(wake_);
}

void ServoLine::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t put = ::write(wake_, &one, sizeof one);
}

void ServoLine::wait_until(Clock::time_point due) {
  const auto left = std::chrono::nanoseconds(due - Clock::now()).count();
  const timespec timeout{.tv_sec = std::max<std::int64_t>(left, 0) / 1'000'000'000,
                         .tv_nsec = std::max<std::int64_t>(left, 0) % 1'000'000'000};
  pollfd event{.fd = wake_, .events = POLLIN, .revents = 0};
  if (::ppoll(&event, 1, &timeout, nullptr) <= 0) return;
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(wake_, &count, sizeof count);
}

std::string ServoLine::open() {
  std::string reason = bus_->open(options_.port);
  if (!reason.empty()) return reason;
  positions_unknown_ = !learn_positions();
  machine_ = DeviceStateMachine();
  connected_.store(true, std::memory_order_release);
  state_ = DeviceState::kHoming;
  return {};
}

void ServoLine::start() {
  start_ = Clock::now();
  last_sent_ = start_ - period_;
  thread_ = std::thread([this] { serve(); });
}

void ServoLine::submit(const Configuration& q, DeviceState state) noexcept {
  Wanted& draft = wanted_.draft();
  draft.q = q;
  draft.state = state;
  wanted_.publish();
  wake();
}

void ServoLine::finish() noexcept {
  if (!thread_.joinable()) return;
  ending_ = true;
  wake();
  thread_.join();
  bus_->close();
  connected_ = false;
  state_ = DeviceState::kStopped;
}

bool ServoLine::read_joints(JointAngles& joints) noexcept {
  report_.refresh();
  if (!report_.latest().known) return false;
  joints = report_.latest().joints;
  return true;
}

bool ServoLine::take_positions(JointAngles& joints) {
  std::array<std::int32_t, kMostServos> positions;
  const auto servos = guard_.servos();
  if (!bus_->take_positions(std::span(positions).first(servos.size()))) return false;
  joints.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    joints[static_cast<Eigen::Index>(i)] = servos[i].joint_of_target(positions[i]);
  }
  return true;
}

bool ServoLine::learn_positions() {
  answers_ = false;
  if (guard_.servos().empty() || !bus_->ask()) return false;
  std::this_thread::sleep_for(kAnswerTime);
  JointAngles joints;
  Configuration q;
  if (!take_positions(joints)) return false;
  answers_ = true;
  const JointLimits& limits = device_->joint_limits();
  const double rounding = 2.0 * guard_.servos().front().resolution();
  const bool within = ((joints - limits.min).array() >= -rounding).all() &&
                      ((limits.max - joints).array() >= -rounding).all();
  if (!within) return false;
  joints = joints.cwiseMax(limits.min).cwiseMin(limits.max);
  if (!device_->forward_kinematics(joints, q)) return false;
  guard_.reset(q);
  report_.draft() = Report{joints, true};
  report_.publish();
  return true;
}

void ServoLine::note_loss() {
  connected_.store(false, std::memory_order_release);
  state_ = DeviceState::kDisconnected;
  lost_.fetch_add(1, std::memory_order_release);
  next_attempt_ = Clock::now() + kAttemptEvery;
}

void ServoLine::try_to_connect(Clock::time_point now) {
  if (now < next_attempt_) return;
  if (open().empty()) {
    connections_.fetch_add(1, std::memory_order_release);
  } else {
    next_attempt_ = Clock::now() + kAttemptEvery;
  }
}

void ServoLine::serve() {
  if (!options_.unpaced) prefer_this_thread(LoopThread::kTransport);
  // Before a fresh command is late, and between repeats.
  const Clock::duration patience = period_ + period_ / 2;
  // A command that comes early is sent early, but commands never crowd.
  const Clock::duration spacing = options_.unpaced ? period_ : period_ / 2;
  Clock::time_point due = Clock::now() + period_;
  while (true) {
    wait_until(due);
    if (bus_->is_open()) std::this_thread::sleep_until(last_sent_ + spacing);
    const Clock::time_point now = Clock::now();
    if (wanted_.refresh()) {
      last_fresh_ = now;
      fresh_ever_ = true;
    }
    if (!bus_->is_open()) {
      if (connected()) note_loss();
      if (ending_) return;
      try_to_connect(now);
      if (!bus_->is_open()) {
        due = now + std::min<Clock::duration>(period_, kAttemptEvery);
        continue;
      }
    }
    if (!fresh_ever_) {
      if (ending_) return;
      bus_->drain();  // nothing to say yet
      due = now + period_;
      continue;
    }
    if (!tick(now)) return;
    due = last_sent_ + (stalled_ || ending_ ? period_ : patience);
  }
}

bool ServoLine::tick(Clock::time_point now) {
  const Clock::duration stall_time = std::max(seconds(kStallTime), 3 * period_);
  const bool stalled = now - last_fresh_ >= stall_time;
  if (stalled && !stalled_ && !ending_) stalls_.fetch_add(1, std::memory_order_release);
  stalled_ = stalled;

  if (answers_) {
    Report& report = report_.draft();
    report.known = take_positions(report.joints);
    if (report.known) report_.publish();
  } else {
    bus_->drain();
  }

  if (positions_unknown_) {
    // The servos may come from as far away as the joints reach; let them get to the first pose.
    const JointLimits& limits = device_->joint_limits();
    homing_until_ = now + seconds((limits.max - limits.min).maxCoeff() / limits.max_rate);
    positions_unknown_ = false;
  }

  const Wanted& wanted = wanted_.latest();
  DeviceState state = machine_.advance({.time = to_seconds(now - start_),
                                        .touching = wanted.state == DeviceState::kRendering,
                                        .ending = ending_,
                                        .stalled = stalled && !ending_,
                                        .arrived = guard_.arrived() && now >= homing_until_});
  if (state == DeviceState::kStopped) return false;
  const bool retracting = state == DeviceState::kRetracting;
  // While it follows, what the loop says it does is what the device does.
  if (state == DeviceState::kReady || state == DeviceState::kRendering) state = wanted.state;

  // Elapsed wall time bounds the motion, and never more than one tick of it.
  const double dt = to_seconds(std::min(now - last_sent_, period_));
  if (now >= homing_until_) guard_.step(retracting ? device_->retracted() : wanted.q, dt);

  last_sent_ = now;
  if (bus_->write(guard_.targets())) {
    sent_.fetch_add(1, std::memory_order_relaxed);
    state_.store(state, std::memory_order_relaxed);
  }
  if (answers_) bus_->ask();
  if (!bus_->is_open()) note_loss();
  return true;
}

}  // namespace softfinger
