#include "live_faults.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "../support/child_process.hpp"

namespace softfinger {
namespace {

void pull_cable(TroubledBoard& board, const LiveFault::Wait& wait) {
  for (const double out : {0.1, 0.3, 0.5}) {
    if (!wait(out)) return;
    board.pull();
    (void)wait(out + 0.1);
    board.plug_in();
  }
}

void reset_board(TroubledBoard& board, const LiveFault::Wait& wait) {
  for (int i = 1; i <= 14; ++i) {
    if (!wait(0.05 * i)) return;
    board.maestro().reset();
  }
}

void cut_packets(TroubledBoard& board, const LiveFault::Wait& wait) {
  (void)wait(0.1);
  board.maestro().cut(true);
  (void)wait(0.7);
  board.maestro().cut(false);
}

void blink(TroubledBoard& board, std::chrono::milliseconds gone) {
  board.pull();
  std::this_thread::sleep_for(gone);
  board.plug_in();
}

constexpr std::chrono::milliseconds kAwayAtEnd{300};

void blink_often(TroubledBoard& board, const LiveFault::Wait& wait) {
  for (int i = 1; i <= 10; ++i) {
    if (!wait(0.06 * i)) return;
    blink(board, std::chrono::milliseconds(20 * i));
  }
  for (int i = 0; i < 3 && wait(1.0); ++i) {
    blink(board, kAwayAtEnd);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
}

void hold_back(TroubledBoard& board, const LiveFault::Wait& wait) {
  for (const double from : {0.1, 0.3, 0.5}) {
    if (!wait(from)) return;
    board.line().hold(true);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    board.line().hold(false);
  }
}

/// Waits for the middle of a contact, well after the start; false: the run has ended.
bool await_contact(const TroubledBoard& board, const LiveFault::Wait& wait) {
  for (double share = 0.3; wait(share); share = 0.0) {
    if (board.presses()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

constexpr std::size_t kDeadServo = 1;

void silence_servo(TroubledBoard& board, const LiveFault::Wait& wait) {
  if (await_contact(board, wait)) board.cut_off(kDeadServo);
}

/// The guard process is the only child of this one.
void send_guard(int signal, const TroubledBoard& board, const LiveFault::Wait& wait) {
  if (!await_contact(board, wait)) return;
  if (const pid_t guard = child_of(::getpid()); guard > 0) ::kill(guard, signal);
}
void kill_guard(TroubledBoard& board, const LiveFault::Wait& wait) {
  send_guard(SIGKILL, board, wait);
}
void stop_guard(TroubledBoard& board, const LiveFault::Wait& wait) {
  send_guard(SIGSTOP, board, wait);
}

constexpr const char* kGuardReplaced = "died or hung; another one retracts the device";

}  // namespace

std::vector<LiveFault> live_faults(double seconds) {
  const auto within = [seconds](double time, double from, double to) {
    return time > from * seconds && time < to * seconds;
  };
  std::vector<LiveFault> faults;
  faults.push_back({.name = "none"});
  faults.push_back({.name = "cable pulled and back, three times", .board = pull_cable});
  faults.push_back({.name = "board reset in mid-frame, 14 times", .board = reset_board});
  faults.push_back({.name = "30 % of the board's packets cut in half", .board = cut_packets});
  faults.push_back({.name = "udp poses: 30 % lost, 10 % doubled, 20 % reordered",
                    .poses = {.loss = 0.3, .duplication = 0.1, .reordering = 0.2}});
  faults.push_back({.name = "natnet frames: the same", .natnet = true});
  faults.push_back({.name = "tracker jumps 1 m and back",
                    .poses = {.jump = [within](double time, std::uint32_t) {
                      return within(time, 0.2, 0.3) || within(time, 0.4, 0.45) ? 1.0 : 0.0;
                    }}});
  faults.push_back({.name = "tracker jumps 1 m in each sample",
                    .poses = {.jump = [within](double time, std::uint32_t number) {
                      return within(time, 0.2, 0.6) && number % 2 == 0 ? 1.0 : 0.0;
                    }}});
  faults.push_back({.name = "tracker's clock steps by an hour and back, and by 0.1 s",
                    .poses = {.clock_ahead = [within](double time) {
                      return within(time, 0.2, 0.4) ? 3600.0 : within(time, 0.5, 0.6) ? -0.1 : 0.0;
                    }}});
  faults.push_back({.name = "disk full", .disk_fills = true});
  faults.push_back({.name = "200 browsers coming and going", .crowd = true});
  faults.push_back({.name = "one of the servos on a bus falls silent",
                    .device = "thimble-3rrs-dynamixel.toml",
                    .board = silence_servo,
                    .stops = true,
                    .told = "servo 2 does not answer; the others retract"});
  faults.push_back(
      {.name = "guard killed", .board = kill_guard, .stops = true, .told = kGuardReplaced});
  faults.push_back(
      {.name = "guard stopped", .board = stop_guard, .stops = true, .told = kGuardReplaced});
  faults.push_back({.name = "port blinks, ten times and at the end",
                    .board = blink_often,
                    .told = "went away",
                    .times_told = 3,
                    .away_at_end = std::chrono::duration<double>(kAwayAtEnd).count()});
  faults.push_back(
      {.name = "line holds bytes back, three times", .board = hold_back, .holds_back = true});
  return faults;
}

}  // namespace softfinger
