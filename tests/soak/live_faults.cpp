#include "live_faults.hpp"

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
  return faults;
}

}  // namespace softfinger
