#pragma once

#include <memory>
#include <optional>
#include <string>

#include "softfinger/actuation/beating_clock.hpp"
#include "softfinger/actuation/device_state.hpp"
#include "softfinger/actuation/joint_ramp.hpp"
#include "softfinger/actuation/line_channel.hpp"
#include "softfinger/actuation/motion_guard.hpp"
#include "softfinger/actuation/servo_lag.hpp"
#include "softfinger/actuation/supervision.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/wire/line_clock.hpp"

namespace softfinger {

/// The servos of one device on their bus, served in wall time by whoever calls serve(): a thread
/// of the loop's process (LineThread) or a process of its own (GuardProcess). It owns the port and
/// is the watchdog: a stop is obeyed at once, whatever the loop says or does not say; when no fresh
/// command comes it repeats the last one, after kStallTime it retracts the device, and it opens a
/// port that went away again. Its own MotionGuard starts from what was really sent last (or from
/// where the servos say they are), so nothing upstream can cause a jump. Where no configuration
/// says where the device is, since servos stand outside of its workspace or one of them cannot be
/// led, it is retracted joint by joint (JointRamp); a servo that is lost stops the device besides.
class ServoLine {
 public:
  struct Options {
    std::string port;
    double rate = 30.0;  ///< device ticks per s
    /// Commands may come faster than `rate`; only the newest at each tick is sent.
    bool unpaced = false;
    std::shared_ptr<const TravelCeiling> ceiling = nullptr;  ///< null: none
  };

  /// The device has a `[transport]`. `wake`: event descriptor that counts what was submitted.
  /// `loop`: a socket that ends when the loop's process does; negative: it is this process. `clock`
  /// outlives the line.
  ServoLine(std::shared_ptr<const Device> device, Options options, LineChannel& channel, int wake,
            int loop = -1, LineClock& clock = steady_line_clock());
  ServoLine(const ServoLine&) = delete;
  ServoLine& operator=(const ServoLine&) = delete;

  /// Opens the port. Returns an empty text or why it cannot be opened.
  [[nodiscard]] std::string open();
  /// Serves until the channel, or the end of the loop's process, says that it ends; then retracts
  /// the device, repeats the command for kRetractedRepeatTime and closes the port. Nothing is sent
  /// if nothing was ever submitted.
  void serve();

 private:
  using TimePoint = LineClock::TimePoint;

  [[nodiscard]] bool ending() const;
  void follow();
  void try_to_connect(TimePoint now);
  void note_loss();
  [[nodiscard]] bool may_come_back(TimePoint now) const;  ///< at the end
  void wait_until(TimePoint due);                         ///< or until something was submitted
  /// Asks for the positions and waits a little; true when they place the device in its workspace.
  bool learn_positions();
  /// Where servos say nothing: goes on from what a line before this one sent last, if one did.
  bool take_over();
  /// Takes an answer that has arrived complete; false if there is none.
  bool take_positions(JointAngles& joints);
  bool tick(TimePoint now);  ///< false: stopped
  void lead(TimePoint now, bool retracting);
  [[nodiscard]] bool arrived(TimePoint now) const;
  /// The newest command that is whole and newer than the last; false: there is none.
  bool take_wanted();
  void note_faults();
  void note_complaints();
  void note_who_follows(TimePoint now, const JointAngles& joints);
  /// The end of a device whose servos are to let go: once they say that they are retracted.
  void let_go();
  [[nodiscard]] bool says_retracted();
  /// Opens the port anew, since a servo that was lost may be back; false: it cannot be opened.
  bool look_for_lost_servos();
  void answer_release(TimePoint now);
  [[nodiscard]] bool stop_is_news() const;
  void tell_delivery();

  std::shared_ptr<const Device> device_;
  Options options_;
  LineChannel& channel_;
  int wake_;
  int loop_;
  BeatingClock clock_;
  int most_unheard_;  ///< ticks
  LineClock::Duration period_;
  std::unique_ptr<ServoBus> bus_;
  MotionGuard guard_;
  JointRamp ramp_;  ///< under way: instead of the guard
  ServoFaults faults_;
  bool complains_ = false;  ///< some servo does
  Supervision supervision_;
  DeviceStateMachine machine_;
  LineChannel::Wanted wanted_;  ///< the line's own: what is shared may change
  ServoLag lag_;
  CommandDelivery delivery_;

  TimePoint start_;
  TimePoint last_sent_;
  TimePoint last_fresh_;
  TimePoint next_attempt_;
  std::optional<TimePoint> ending_since_;
  TimePoint lost_;                 ///< when the port went away last
  bool positions_unknown_ = true;  ///< since the port was opened
  TimePoint homing_until_;         ///< positions unknown: stay at the first pose until then
  TimePoint asked_;                ///< when the servos were last asked where they are
  bool fresh_ever_ = false;
  bool fresh_ = false;  ///< what is wanted was not sent yet
  bool stalled_ = false;
  bool answers_ = false;  ///< the servos answered when the port was opened
  int unheard_ = kNever;  ///< ticks since they last said where they are
  static constexpr int kNever = -1;
  std::optional<TimePoint> retracted_since_;  ///< the retracted pose is commanded; empty: it is not
  bool loop_gone_ = false;                    ///< the loop's process has ended
};

}  // namespace softfinger
