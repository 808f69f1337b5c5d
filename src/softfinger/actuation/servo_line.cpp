#include "softfinger/actuation/servo_line.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_priority.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAttemptEvery{300};   ///< to open a port that is not there
constexpr milliseconds kAnswerTime{60};      ///< for the positions after opening
constexpr milliseconds kLongestAnswer{250};  ///< the same, on a machine that is busy
/// Servos that said where they are and then nothing for so many ticks, and so long, may be without
/// power: what is sent stands still until they answer again, so that they do not jump to it.
constexpr int kMostUnheard = 3;
constexpr double kLongestUnheard = 0.1;  ///< s
/// A port that went away so shortly before the end may be back in a moment (USB that is enumerated
/// anew), with servos that press.
constexpr milliseconds kBlink{3000};
/// And no end takes longer because of ports that come and go.
constexpr milliseconds kLongestEnd{15000};
/// At the end: for servos to say that they are retracted, before they let go.
constexpr milliseconds kArrivalTime{1000};
constexpr milliseconds kBeforeAnswers{20};
/// Steps of the wire that a joint moves before its lag is told.
constexpr double kLagMotion = 20.0;

LineClock::Duration seconds(double s) {
  return std::chrono::duration_cast<LineClock::Duration>(std::chrono::duration<double>(s));
}

double to_seconds(LineClock::Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

ServoLine::ServoLine(std::shared_ptr<const Device> device, Options options, LineChannel& channel,
                     int wake, int loop, LineClock& clock)
    : device_(std::move(device)),
      options_(std::move(options)),
      channel_(channel),
      wake_(wake),
      loop_(loop),
      clock_(clock, channel.beat),
      most_unheard_(std::max(kMostUnheard, static_cast<int>(kLongestUnheard * options_.rate))),
      period_(seconds(1.0 / options_.rate)),
      bus_(make_servo_bus(*device_->settings().transport, clock_)),
      guard_(device_, device_->settings().transport->servos, options_.ceiling),
      ramp_(device_, guard_.servos()),
      supervision_(*device_),
      wanted_{.q = device_->home()},
      lag_(static_cast<Eigen::Index>(guard_.servos().size()),
           guard_.servos().empty() ? 0.0 : kLagMotion * guard_.servos().front().resolution()) {}

bool ServoLine::ending() const { return loop_gone_ || channel_.ending.load(); }

void ServoLine::wait_until(TimePoint due) {
  std::array events{pollfd{.fd = wake_, .events = POLLIN, .revents = {}},
                    pollfd{.fd = loop_gone_ ? -1 : loop_, .events = POLLIN, .revents = {}}};
  if (!clock_.wait(events, due)) return;
  loop_gone_ = loop_gone_ || events[1].revents != 0;  // it says nothing, so this is its end
  if (events[0].revents == 0) return;
  std::uint64_t count{};
  [[maybe_unused]] const ssize_t got = ::read(wake_, &count, sizeof count);
}

std::string ServoLine::open() {
  if (channel_.commands_sent != 0) bus_->lead_those_left();
  std::string reason = bus_->open(options_.port);
  if (!reason.empty()) return reason;
  ramp_.end();
  retracted_since_.reset();
  positions_unknown_ = !learn_positions() && !take_over();
  note_faults();
  machine_ = DeviceStateMachine();
  lag_.reset();
  supervision_.restart();
  channel_.astray = 0;
  channel_.connected.store(true, std::memory_order_release);
  channel_.state = DeviceState::kHoming;
  return {};
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
  unheard_ = kNever;
  if (guard_.servos().empty() || !bus_->ask()) return false;
  const TimePoint asked = clock_.now();
  JointAngles joints;
  bool known = false;
  for (milliseconds wait = kAnswerTime; !answers_ && clock_.now() - asked < kLongestAnswer;
       wait = kBeforeAnswers) {
    clock_.sleep_for(wait);
    known = take_positions(joints);
    answers_ = known || bus_->answers();
  }
  if (!known) return false;
  channel_.report.draft() = LineChannel::Report{joints, true};
  channel_.report.publish();
  const ServoFaults faults = bus_->faults();
  for (std::size_t i = 0; i < guard_.servos().size(); ++i) {
    // What it was sent last is all that is known of it.
    if (faults.has(i)) joints[Eigen::Index(i)] = guard_.joints()[Eigen::Index(i)];
  }
  const JointLimits& limits = device_->joint_limits();
  const double rounding = 2.0 * guard_.servos().front().resolution();
  const bool within = ((joints - limits.min).array() >= -rounding).all() &&
                      ((limits.max - joints).array() >= -rounding).all();
  Configuration q;
  if (within && faults.any() == 0 &&
      device_->forward_kinematics(joints.cwiseMax(limits.min).cwiseMin(limits.max), q)) {
    guard_.reset(q);
  } else {
    ramp_.start(joints);
  }
  return true;
}

void ServoLine::note_faults() {
  const ServoFaults faults = bus_->faults();
  if (faults == faults_) return;
  const bool more = (faults.any() & ~faults_.any()) != 0;
  faults_ = faults;
  channel_.faults.store(faults);
  if (!more) return;
  channel_.stop.stop(StopCause::kServo);
  if (!ramp_.is_under_way()) ramp_.start(guard_.joints());
}

void ServoLine::note_complaints() {
  bool more = false;
  complains_ = false;
  for (std::size_t i = 0; i < guard_.servos().size(); ++i) {
    const std::uint8_t complaints = bus_->complaints(i);
    more = more || (complaints & ~channel_.complaints[i].load()) != 0;
    complains_ = complains_ || complaints != 0;
    channel_.complaints[i] = complaints;
  }
  if (more) channel_.stop.stop(StopCause::kServo);
}

bool ServoLine::look_for_lost_servos() {
  bus_->close();
  const bool open = this->open().empty();
  if (!open) channel_.stop.answer_release(ReleaseRefusal::kServoFault);
  return open;
}

bool ServoLine::take_over() {
  if (fresh_ever_ || channel_.commands_sent == 0 || guard_.servos().empty()) return false;
  channel_.sent.refresh();
  const LineChannel::Sent& sent = channel_.sent.latest();
  if (!sent.is_whole() || sent.q.size() != device_->home().size() || !sent.q.allFinite()) {
    return false;
  }
  guard_.reset(sent.q);
  return true;
}

bool ServoLine::take_wanted() {
  if (!channel_.wanted.refresh()) return false;
  const LineChannel::Wanted& next = channel_.wanted.latest();
  if (!next.is_whole() || next.number <= wanted_.number) {
    channel_.commands_refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  wanted_ = next;
  return true;
}

void ServoLine::note_loss() {
  channel_.connected.store(false, std::memory_order_release);
  channel_.state = DeviceState::kDisconnected;
  channel_.times_lost.fetch_add(1, std::memory_order_release);
  lost_ = clock_.now();
  next_attempt_ = lost_ + kAttemptEvery;
}

bool ServoLine::may_come_back(TimePoint now) const {
  return channel_.commands_sent != 0 && now - lost_ < kBlink && now - *ending_since_ < kLongestEnd;
}

void ServoLine::try_to_connect(TimePoint now) {
  if (now < next_attempt_) return;
  if (open().empty()) {
    channel_.times_connected.fetch_add(1, std::memory_order_release);
  } else {
    next_attempt_ = clock_.now() + kAttemptEvery;
  }
}

void ServoLine::serve() {
  start_ = clock_.now();
  lost_ = start_;  // a line before this one may have had the port
  follow();
  if (device_->settings().transport->limp_at_end && channel_.commands_sent != 0) let_go();
  bus_->close();
  channel_.connected = false;
  channel_.state = DeviceState::kStopped;
}

void ServoLine::follow() {
  if (!options_.unpaced) prefer_this_thread(LoopThread::kTransport);
  // Before a fresh command is late, and between repeats.
  const LineClock::Duration patience = period_ + period_ / 2;
  // A command that comes early is sent early, but commands never crowd.
  const LineClock::Duration spacing = options_.unpaced ? period_ : period_ / 2;
  TimePoint due = clock_.now() + period_;
  while (true) {
    wait_until(due);
    channel_.answer = channel_.question.load();
    if (bus_->is_open() && !stop_is_news()) clock_.sleep_until(last_sent_ + spacing);
    TimePoint now = clock_.now();
    if (ending() && !ending_since_) ending_since_ = now;
    if (take_wanted()) {
      last_fresh_ = now;
      fresh_ever_ = fresh_ = true;
    }
    if (!bus_->is_open()) {
      if (channel_.connected.load()) note_loss();
      if (ending() && !may_come_back(now)) return;
      channel_.stop.answer_release(ReleaseRefusal::kPortClosed);
      try_to_connect(now);
      if (!bus_->is_open()) {
        due = now + std::min<LineClock::Duration>(period_, kAttemptEvery);
        continue;
      }
      now = clock_.now();  // opening takes its time
    }
    if (faults_.any() != 0 && channel_.stop.release_is_asked() && !look_for_lost_servos()) continue;
    if (!fresh_ever_ && !channel_.stop.is_stopped()) {
      if (ending()) return;
      bus_->drain();  // nothing to say yet
      due = now + period_;
      continue;
    }
    if (!tick(now)) return;
    due = last_sent_ + (stalled_ || ending() ? period_ : patience);
  }
}

void ServoLine::tell_delivery() {
  delivery_.send = monotonic_time() - wanted_.formed;
  channel_.delivery.draft() = delivery_;
  channel_.delivery.publish();
  delivery_ = CommandDelivery();
}

bool ServoLine::says_retracted() {
  JointAngles goal;
  JointAngles joints;
  if (!device_->inverse_kinematics(device_->retracted(), goal)) return false;
  if (!take_positions(joints) || joints.size() != goal.size()) return false;
  return (joints - goal).cwiseAbs().maxCoeff() <= device_->settings().following_error;
}

void ServoLine::let_go() {
  const TimePoint until = clock_.now() + kArrivalTime;
  while (answers_ && bus_->is_open() && clock_.now() < until) {
    bus_->ask();
    clock_.sleep_for(kBeforeAnswers);
    if (says_retracted()) break;
  }
  // One that is not there presses perhaps, and holding it helps nobody.
  while (!bus_->let_go() && bus_->is_open() && clock_.now() < until + kArrivalTime) {
    clock_.sleep_for(kBeforeAnswers);  // what waits on a slow line goes first
  }
  clock_.sleep_for(kBeforeAnswers);
}

void ServoLine::note_who_follows(TimePoint now, const JointAngles& joints) {
  if (now < homing_until_) return;
  const std::uint32_t astray = supervision_.seen(to_seconds(now - start_), joints) & ~faults_.any();
  const bool more = (astray & ~channel_.astray.load()) != 0;
  channel_.astray = astray;
  if (more) channel_.stop.stop(StopCause::kServo);
}

bool ServoLine::stop_is_news() const {
  return channel_.stop.is_stopped() && channel_.stop.confirmed() != channel_.stop.newest();
}

void ServoLine::answer_release(TimePoint now) {
  if (!channel_.stop.release_is_asked()) return;
  ReleaseRefusal reason = ReleaseRefusal::kNone;
  if (now - last_fresh_ >= 2 * period_) {
    reason = ReleaseRefusal::kNoCommands;
  } else if (unheard_ > most_unheard_ || faults_.any() != 0 || channel_.astray != 0 || complains_) {
    reason = ReleaseRefusal::kServoFault;
  } else if (!retracted_since_ || now - *retracted_since_ < seconds(kRetractedRepeatTime)) {
    reason = ReleaseRefusal::kRetracting;
  }
  channel_.stop.answer_release(reason);
}

bool ServoLine::arrived(TimePoint now) const {
  return ramp_.is_under_way() ? ramp_.arrived() : guard_.arrived() && now >= homing_until_;
}

void ServoLine::lead(TimePoint now, bool retracting) {
  // Elapsed wall time bounds the motion, and never more than one tick of it.
  const double dt = to_seconds(std::min(now - last_sent_, period_));
  if (ramp_.is_under_way()) {
    if (ramp_.arrived() && faults_.any() == 0) {
      guard_.reset(device_->retracted());
      ramp_.end();
    } else {
      ramp_.step(dt);
    }
    return;
  }
  // Away from the finger it goes even where nobody answers.
  if (retracting || (now >= homing_until_ && unheard_ <= most_unheard_)) {
    guard_.step(retracting ? device_->retracted() : wanted_.q, dt);
  }
}

bool ServoLine::tick(TimePoint now) {
  const LineClock::Duration stall_time = std::max(seconds(kStallTime), 3 * period_);
  const bool stalled = now - last_fresh_ >= stall_time;
  if (stalled && !stalled_ && fresh_ever_ && !ending())
    channel_.times_stalled.fetch_add(1, std::memory_order_release);
  stalled_ = stalled;

  if (answers_) {
    LineChannel::Report& report = channel_.report.draft();
    report.known = take_positions(report.joints);
    if (report.known) {
      delivery_.servo = lag_.seen(to_seconds(asked_ - start_), report.joints)
                            .value_or(std::numeric_limits<double>::quiet_NaN());
      note_who_follows(now, report.joints);
      channel_.report.publish();
    }
    if (report.known || unheard_ != kNever) unheard_ = report.known ? 0 : unheard_ + 1;
  } else {
    bus_->drain();
  }

  if (positions_unknown_) {
    // The servos may come from as far away as the joints reach; let them get to the first pose.
    const JointLimits& limits = device_->joint_limits();
    homing_until_ = now + seconds((limits.max - limits.min).maxCoeff() / limits.max_rate);
    positions_unknown_ = false;
  }

  note_faults();
  note_complaints();
  const bool presses = channel_.state.load() == DeviceState::kRendering;
  if (supervision_.pressed_too_long(to_seconds(now - start_), presses) && presses) {
    channel_.stop.stop(StopCause::kPressed);
  }
  answer_release(now);
  const StopLatch::Number stop = channel_.stop.newest();
  const bool stopped = channel_.stop.is_stopped();
  DeviceState state = machine_.advance({.time = to_seconds(now - start_),
                                        .touching = wanted_.state == DeviceState::kRendering,
                                        .ending = ending(),
                                        .emergency = stopped,
                                        .stalled = stalled && !ending(),
                                        .arrived = arrived(now)});
  if (state == DeviceState::kStopped) return false;
  const bool retracting = state == DeviceState::kRetracting;
  // While it follows, what the loop says it does is what the device does.
  if (state == DeviceState::kReady || state == DeviceState::kRendering) state = wanted_.state;

  lead(now, retracting);
  if (ramp_.is_under_way()) state = DeviceState::kRetracting;

  last_sent_ = now;
  if (bus_->write(ramp_.is_under_way() ? ramp_.targets() : guard_.targets())) {
    channel_.commands_sent.fetch_add(1, std::memory_order_relaxed);
    channel_.state.store(state, std::memory_order_relaxed);
    if (stopped) channel_.stop.confirm(stop);
    LineChannel::Sent& sent = channel_.sent.draft();
    sent.q = guard_.configuration();
    sent.seal = sent.seal_of_this();
    channel_.sent.publish();
    if (!retracting || !arrived(now)) {
      retracted_since_.reset();
    } else if (!retracted_since_) {
      retracted_since_ = now;
    }
    const JointAngles& joints = ramp_.is_under_way() ? ramp_.joints() : guard_.joints();
    lag_.sent(to_seconds(now - start_), joints);
    supervision_.sent(to_seconds(now - start_), joints);
    if (fresh_) tell_delivery();
    fresh_ = false;
  }
  if (answers_) {
    asked_ = clock_.now();
    bus_->ask();
  }
  if (!bus_->is_open()) note_loss();
  return true;
}

}  // namespace softfinger
