#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/rendering.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// One finger of a Rendering: what the caller hands over, its chain, and what it commands.
class RenderedFinger {
 public:
  /// The finger of this number; `setup` must outlive it, as must the `team`. Throws InputError
  /// where its device cannot be opened.
  RenderedFinger(const RunSetup& setup, std::size_t number, const RenderingOptions& options,
                 ThreadTeam* team);
  RenderedFinger(const RenderedFinger&) = delete;
  RenderedFinger& operator=(const RenderedFinger&) = delete;
  ~RenderedFinger() = default;

  [[nodiscard]] FingerChain& chain() { return chain_; }
  [[nodiscard]] const FingerChain& chain() const { return chain_; }
  [[nodiscard]] const RenderingCommand& command() const { return command_; }
  [[nodiscard]] Actuator* actuator();  ///< null: no device
  [[nodiscard]] const Actuator* actuator() const;
  [[nodiscard]] std::vector<std::string> configuration_names() const;
  [[nodiscard]] const std::vector<std::array<int, 3>>& skin_triangles() const {
    return model_->skin_triangles;
  }
  [[nodiscard]] std::optional<std::string> take_message();

  /// The caller's pose at `time` (s, the caller's); one that is empty or not finite is lost
  /// tracking.
  void hand_over(const std::optional<Pose>& X_WFt, double time);
  /// What was handed over last, as tracked.
  [[nodiscard]] TrackedInput target() const { return TrackedInput(target_); }
  /// Of step `step` of `count` that lead there, at `time` (s, of the run).
  [[nodiscard]] TrackedInput on_the_way(std::int64_t step, std::int64_t count, double time) const;
  /// All of them are done.
  void arrive() { from_ = target_.X_WFt; }

  /// A tick of the last step, about a pose that came at `arrival`; `origin` is the caller's time at
  /// step 0, s.
  const TickRecord& tick(std::chrono::steady_clock::time_point arrival, double origin);
  /// Into the command.
  void tell_stops();

 private:
  /// What the caller hands over, as a tracker.
  struct HandedPose final : Tracker {
    explicit HandedPose(const TrackedPose& newest) : pose(newest) {}
    TrackedPose sample(double) override { return pose; }
    [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
    const TrackedPose& pose;
  };

  std::shared_ptr<const FingerModel> model_;
  std::vector<DeviceNotice> notices_;
  std::size_t notices_told_ = 0;
  TrackedPose handed_;
  std::unique_ptr<Tracker> conditioned_;  ///< what is made of that
  FingerChain chain_;
  RenderingCommand command_;
  double servo_step_ = 0.0;  ///< set point of one step of the wire
  bool seen_ = false;        ///< a valid pose
  TrackedPose target_;
  Pose from_;  ///< tracked pose of the last step
};

/// What is made of handed poses, by the options. Throws InputError.
[[nodiscard]] PoseConditioning conditioning_of(const RenderingOptions& options);

}  // namespace softfinger
