#include "softfinger/world/world_events.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace softfinger {
namespace {

/// Of a joint that rests at its limit, N or N m.
constexpr double kLimitRounding = 1e-9;

}  // namespace

const char* event_name(EventKind kind) {
  constexpr std::array kNames{"impact", "release", "click", "detent", "limit"};
  return kNames[static_cast<std::size_t>(kind)];
}

WorldEvents::WorldEvents(std::span<const int> moving, std::size_t objects, std::size_t fingers,
                         std::span<const Joint> joints, double time_step)
    : others_(objects + fingers),
      time_step_(time_step),
      apart_(std::max(1L, std::lround(kApart / time_step))),
      blow_(std::max(1L, std::lround(kBlow / time_step))),
      moving_(moving.begin(), moving.end()),
      row_of_(objects, -1),
      meetings_(moving.size() * others_) {
  for (std::size_t row = 0; row < moving.size(); ++row) {
    row_of_[static_cast<std::size_t>(moving[row])] = static_cast<int>(row);
  }
  for (const Joint& joint : joints) {
    joints_.emplace_back().joint = joint;
    joints_.back().passed.resize(joint.snaps.size());
  }
  lies_.assign(moving.size(), 0);
  open_.reserve(kMostOpen);
  told_.reserve(kMostOpen);
  reset();
}

void WorldEvents::reset() {
  std::fill(meetings_.begin(), meetings_.end(), Meeting{});
  for (JointMemory& memory : joints_) {
    memory.now = memory.before = {};
    memory.momentum = memory.old_momentum = 0.0;
    memory.limit = {};
    for (std::size_t s = 0; s < memory.passed.size(); ++s) {
      const ForceCurve::Snap& snap = memory.joint.snaps[s];
      memory.passed[s] = {snap.top < 0.0, snap.valley < 0.0};  // at q = 0
    }
  }
  open_.clear();
  told_.clear();
  step_ = 1;
}

void WorldEvents::touch(int object, int other, double normal_force) {
  const auto row_of = [&](int thing) {
    const auto t = static_cast<std::size_t>(thing);
    return t < row_of_.size() ? row_of_[t] : -1;
  };
  if (object > other) std::swap(object, other);
  int row = row_of(object);
  if (row < 0) {
    row = row_of(other);
    std::swap(object, other);
  }
  if (row < 0) return;
  meetings_[static_cast<std::size_t>(row) * others_ + static_cast<std::size_t>(other)].force +=
      normal_force;
}

void WorldEvents::lie(int object) {
  lies_[static_cast<std::size_t>(row_of_[static_cast<std::size_t>(object)])] = 1;
}

void WorldEvents::joint(std::size_t joint, const JointState& state) { joints_[joint].now = state; }

bool WorldEvents::meets(Meeting& meeting, bool& released) const {
  released = false;
  if (!(meeting.force > 0.0)) {
    released = meeting.together && step_ - meeting.last >= apart_;
    if (released) meeting.together = false;
    return false;
  }
  const bool anew = meeting.last == kNever ? step_ > 1 : step_ - meeting.last >= apart_;
  meeting.last = step_;
  meeting.together = true;
  return anew;
}

WorldEvents::Open* WorldEvents::open(EventKind kind, int object, int other, std::int64_t steps) {
  if (open_.size() == kMostOpen) return nullptr;
  Open& made = open_.emplace_back();
  made.event = {.time = static_cast<double>(step_) * time_step_,
                .kind = kind,
                .object = object,
                .other = other};
  made.until = step_ + steps - 1;
  made.is_over = steps == 0;
  return &made;
}

void WorldEvents::end_pairs() {
  for (std::size_t row = 0; row < moving_.size(); ++row) {
    for (std::size_t k = 0; k < others_; ++k) {
      Meeting& meeting = meetings_[row * others_ + k];
      if (lies_[row] != 0) {
        if (meeting.together) meeting.last = step_;
        continue;
      }
      bool released = false;
      const bool anew = meets(meeting, released);
      if (!anew && !released) continue;
      // The first of the scene first.
      const int first = std::min(moving_[row], static_cast<int>(k));
      const int second = std::max(moving_[row], static_cast<int>(k));
      Open* const made =
          open(anew ? EventKind::kImpact : EventKind::kRelease, first, second, anew ? blow_ : 0);
      if (made == nullptr || !anew) continue;
      made->of = &meeting;
      made->event.impulse = 0.0;
    }
  }
}

void WorldEvents::find_clicks(JointMemory& memory) {
  const double travel = -memory.now.q;
  for (std::size_t s = 0; s < memory.passed.size(); ++s) {
    Passed& passed = memory.passed[s];
    const Passed was = passed;
    passed = {travel > memory.joint.snaps[s].top, travel > memory.joint.snaps[s].valley};
    const bool inwards = passed.top && !was.top;
    const bool outwards = was.valley && !passed.valley;
    if (!inwards && !outwards) continue;
    Open* const made = open(EventKind::kClick, memory.joint.object, -1, apart_);
    if (made == nullptr) continue;
    made->joint = &memory;
    made->snap = s;
    made->inwards = inwards;
    made->momentum = memory.old_momentum;
  }
}

void WorldEvents::end_joint(JointMemory& memory) {
  memory.old_momentum = memory.momentum;
  memory.momentum = memory.joint.mass * (memory.now.q - memory.before.q) / time_step_;
  find_clicks(memory);
  if (memory.now.detent != memory.before.detent) {
    open(EventKind::kDetent, memory.joint.object, -1, 0);
  }
  const double force = std::abs(memory.now.limit_force);
  memory.limit.force = force > kLimitRounding ? force : 0.0;
  bool released = false;
  if (meets(memory.limit, released)) {
    Open* const made =
        open(EventKind::kLimit, memory.joint.object, -1, memory.joint.mass > 0.0 ? blow_ : 0);
    if (made != nullptr && memory.joint.mass > 0.0) {
      made->of = &memory.limit;
      made->event.impulse = 0.0;
    }
  }
}

void WorldEvents::follow_click(Open& open) const {
  const ForceCurve::Snap& snap = open.joint->joint.snaps[open.snap];
  const double travel = -open.joint->now.q;
  const bool done = open.inwards ? travel > snap.valley : travel <= snap.top;
  const bool back = open.inwards ? travel <= snap.top : travel > snap.valley;
  if (done) {
    const double gained = open.joint->momentum - open.momentum;
    open.event.impulse = open.inwards ? -gained : gained;
  }
  open.is_over = done || back;
}

void WorldEvents::follow(Open& open) const {
  if (open.is_over) return;
  if (open.of != nullptr) open.event.impulse += time_step_ * open.of->force;
  if (open.joint != nullptr) follow_click(open);
  if (step_ >= open.until) open.is_over = true;
}

void WorldEvents::tell() {
  told_.clear();
  const auto first_open = std::ranges::find(open_, false, &Open::is_over);
  for (auto over = open_.begin(); over != first_open; ++over) told_.push_back(over->event);
  open_.erase(open_.begin(), first_open);
}

void WorldEvents::end_step() {
  end_pairs();
  for (JointMemory& memory : joints_) end_joint(memory);
  for (Open& open : open_) follow(open);
  tell();
  for (Meeting& meeting : meetings_) meeting.force = 0.0;
  std::ranges::fill(lies_, std::uint8_t{0});
  for (JointMemory& memory : joints_) memory.before = memory.now;
  ++step_;
}

void WorldEvents::finish() {
  for (Open& open : open_) open.is_over = true;
  tell();
}

}  // namespace softfinger
