#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// A live feed without an engine behind it: an ellipsoid pad bobs against a plane, a ball or a box
/// and is cut off at the surface, a 3-RRS platform follows. Made to look at, and to test the server
/// and the page: "hand" has five fingers, two of whose devices are not as they should be, "relief"
/// one with such a device, "plane" one that the page moves, "cylinder" one that a headset moves,
/// "corner" one without a twin.
class SyntheticFeed : public LiveFeed {
 public:
  SyntheticFeed();

  std::shared_ptr<const SceneDescription> description() override;
  bool refresh() override;  ///< advances by a sixtieth of a second unless paused
  const Snapshot& latest() const override { return snapshot_; }
  void request(const LiveRequest& request) override;

  void offer_hand(const XrHand& hand) override;
  const RegistrationState& registration() const override { return registration_; }
  FitState fit() override { return fit_; }
  std::optional<std::string> take_message() override;
  std::string loading() override;

  /// From now on that scene is being loaded; empty: none. Any thread.
  void set_loading(const std::string& scene);
  /// From now on nothing new comes but for what is asked for. Any thread.
  void set_frozen(bool frozen) { frozen_ = frozen; }
  /// Something for people. Any thread.
  void say(const std::string& line);

  /// Hands received so far.
  [[nodiscard]] std::vector<XrHand> hands() const;
  /// Requests received so far.
  [[nodiscard]] std::vector<LiveRequest> requests() const;

 private:
  void start_scene(const std::string& name);
  void fill_snapshot();
  void fill_finger(std::size_t index);

  std::shared_ptr<const SceneDescription> description_;
  Pose X_WO_;
  Snapshot snapshot_;
  mutable std::mutex mutex_;
  std::vector<LiveRequest> requests_;
  std::vector<XrHand> hands_;
  std::deque<std::string> lines_;
  std::string loading_;
  std::atomic<bool> frozen_{false};
  bool asked_ = false;              ///< since the last snapshot
  RegistrationState registration_;  ///< runs, at its second posture, since one was asked for
  FitState fit_;                    ///< at its third press, since one was asked for
};

}  // namespace softfinger
