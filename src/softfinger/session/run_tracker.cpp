#include "softfinger/session/run_tracker.hpp"

#include <fmt/core.h>

#include "softfinger/base/error.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"
#include "softfinger/tracking/page_tracker.hpp"
#include "softfinger/tracking/registration/registered_tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {

RunTracker::RunTracker(const RunSetup& setup, std::size_t finger, const RunOptions& options,
                       bool live) {
  const SceneFinger& scene_finger = setup.scene.fingers[finger];
  const bool network = is_network_tracker(parse_tracker_spec(scene_finger.tracker).kind);
  if (!live && options.as_fast_as_possible && network) {
    throw InputError(
        fmt::format("finger {}: tracker {} sends as time passes, and a run as fast as possible "
                    "does not wait for it; use script or csv:FILE",
                    scene_finger.name, scene_finger.tracker));
  }
  tracker_ = scene_finger.make_tracker(setup.tracker_directories[finger]);
  page_tracker_ = dynamic_cast<PageTracker*>(tracker_.get());
  webxr_tracker_ = dynamic_cast<WebXrTracker*>(tracker_.get());
  const bool at_page = page_tracker_ != nullptr || webxr_tracker_ != nullptr;
  if (at_page && !live) {
    throw InputError(
        fmt::format("finger {}: tracker {} is a person at the live page; a headless run has none",
                    scene_finger.name, scene_finger.tracker));
  }
  if (const auto& X_BodyFt = setup.registrations[finger]) {
    tracker_ = std::make_unique<RegisteredTracker>(std::move(tracker_), *X_BodyFt);
  }
  const bool sent = at_page || network;
  tracker_ = conditioned(std::move(tracker_), options.conditioning, sent);
  conditioning_ = conditioning_text(options.conditioning, sent);
}

RunTracker::~RunTracker() = default;

std::optional<std::string> RunTracker::take_message() {
  return tracker_ ? tracker_->take_message() : std::nullopt;
}

void RunTracker::offer(const Pose& X_WFt) noexcept {
  if (page_tracker_ != nullptr) page_tracker_->offer(X_WFt);
}

void RunTracker::offer(const XrHand& hand) noexcept {
  if (webxr_tracker_ != nullptr) webxr_tracker_->offer(hand);
}

void RunTracker::close() {
  if (page_tracker_ == nullptr && webxr_tracker_ == nullptr) tracker_.reset();
}

}  // namespace softfinger
