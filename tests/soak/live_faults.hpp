#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pose_sender.hpp"
#include "troubled_board.hpp"

namespace softfinger {

/// What goes wrong around a live run.
struct LiveFault {
  /// Waits until a share of the run's steps are over; false: it has ended, and the device too.
  using Wait = std::function<bool(double share)>;

  std::string name;
  PoseTrouble poses = {};
  bool natnet = false;      ///< poses come from a NatNet server that loses, doubles and reorders
  bool disk_fills = false;  ///< the recording may not grow
  bool crowd = false;       ///< 200 visitors come and go
  /// In devices/, instead of the scene's; empty: the scene's.
  std::string device = {};
  /// Done to the board or to whoever leads it, on a thread of its own; empty: nothing.
  std::function<void(TroubledBoard&, const Wait&)> board = nullptr;
  /// Ends with the device stopped: it retracts from then on, and nothing starts it again.
  bool stops = false;
  /// Part of a line that people must be told, and how often at least; empty: of none.
  std::string told = {};
  int times_told = 1;
  double away_at_end = 0.0;  ///< the port is gone so long, s, as the device retracts in the end
  bool holds_back = false;   ///< bytes wait in the line
};

/// The first is none. Those of a moment happen within the first 70 % of a run of `seconds`.
[[nodiscard]] std::vector<LiveFault> live_faults(double seconds);

}  // namespace softfinger
