#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pose_sender.hpp"
#include "troubled_board.hpp"

namespace softfinger {

/// What goes wrong around a live run.
struct LiveFault {
  /// Waits until a share of the run is over; false: it has ended.
  using Wait = std::function<bool(double share)>;

  std::string name;
  PoseTrouble poses = {};
  bool natnet = false;      ///< poses come from a NatNet server that loses, doubles and reorders
  bool disk_fills = false;  ///< the recording may not grow
  bool crowd = false;       ///< 200 visitors come and go
  /// Done to the board, on a thread of its own; empty: nothing.
  std::function<void(TroubledBoard&, const Wait&)> board = nullptr;
};

/// The first is none. Those of a moment happen within the first 70 % of a run of `seconds`.
[[nodiscard]] std::vector<LiveFault> live_faults(double seconds);

}  // namespace softfinger
