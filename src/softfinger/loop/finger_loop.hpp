#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/recording/record.hpp"

namespace softfinger {

/// The tracked pose may move the simulated finger no faster than this; a larger jump (a glitch, or
/// tracking found again elsewhere) is caught up with at this speed. Hands in contact are slower.
inline constexpr double kMaxTrackedSpeed = 1.0;          ///< m/s
inline constexpr double kMaxTrackedAngularSpeed = 67.0;  ///< rad/s

/// The simulation side of one finger: tracked pose to contact set, step by step. The same code
/// serves headless and live runs, replays and the library. Neither step() nor seal() allocates,
/// locks or throws.
class FingerLoop {
 public:
  /// `objects` must outlive the loop. simulation_rate in Hz. `with_state`: records carry nodes and
  /// samples. `team`, `hand`: see FingerSimulation.
  FingerLoop(std::int64_t finger, std::shared_ptr<const FingerModel> model,
             std::span<const VirtualObject> objects, double simulation_rate, bool with_state,
             ThreadTeam* team = nullptr, int hand = -1);

  /// Step 0: at rest at the tracked pose; before the first valid one the finger is nowhere and
  /// touches nothing.
  void start(const TrackedInput& tracked);
  /// Step `step` (from 1), to its end at step / simulation_rate.
  void step(std::int64_t step, const TrackedInput& tracked);
  /// The same in two parts, with the solution of the simulation's step between them. False: there
  /// is none to solve, the finger is nowhere.
  bool begin_step(std::int64_t step, const TrackedInput& tracked);
  /// `solving`: what the solution took, s.
  struct SolvingTime {
    double cpu = 0.0, wall = 0.0;
  };
  void end_step(const StepSummary& summary, SolvingTime solving);
  /// Completes the record of the step: `tick` is the newest device tick known to it (-1: none) and
  /// `tick_hash` that tick's hash. `world`: hash of what moves beside the finger; 0: nothing does.
  const StepRecord& seal(std::int64_t tick, std::uint64_t tick_hash, std::uint64_t world = 0);

  [[nodiscard]] const StepRecord& record() const { return record_; }
  [[nodiscard]] const FingerSimulation& simulation() const { return simulation_; }
  [[nodiscard]] FingerSimulation& simulation() { return simulation_; }
  [[nodiscard]] const ContactSet& contact() const { return simulation_.contact(); }

 private:
  /// At rest there at the end of the step before; it may be inside something.
  void place(std::int64_t step);
  void read_simulation();

  FingerSimulation simulation_;
  double simulation_rate_;
  bool placed_ = false;                      ///< a valid pose has been seen
  bool takes_part_ = false;                  ///< in the step under way
  double cpu_time_ = 0.0, wall_time_ = 0.0;  ///< of its beginning, s
  Pose X_WFt_limited_;
  StepRecord record_;
};

}  // namespace softfinger
