#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/session/live_feed.hpp"
#include "softfinger/session/live_fit.hpp"
#include "softfinger/session/live_registration.hpp"
#include "softfinger/session/run_observer.hpp"
#include "softfinger/session/scene_load.hpp"
#include "softfinger/session/scene_run.hpp"

namespace softfinger {

/// Runs a scene without a page until it ends or `stop` becomes true; where that is while the scene
/// loads nothing is opened, and the summary is empty. Throws InputError, and OperationError when
/// the recording could not be written.
RunSummary run_headless(const RunOptions& options, const std::atomic<bool>& stop,
                        const RunObserver& observer = {}, SceneRun::Hooks hooks = {});
/// The same with a setup loaded already, by load_setup for these options.
RunSummary run_headless(std::shared_ptr<const RunSetup> setup, const RunOptions& options,
                        const std::atomic<bool>& stop, const RunObserver& observer = {},
                        SceneRun::Hooks hooks = {});

/// A live run and what the page asks of it: pause, restart, another scene. Each restart is a run of
/// its own, a generation; recordings after the first get "-2", "-3", ... before the extension.
class LiveSession final : public LiveFeed {
 public:
  /// Loads the scene and opens its devices. The page may choose from the scenes in the directory
  /// of this one. `repeat`: a script that ends starts over. Throws InputError.
  LiveSession(const RunOptions& options, bool repeat, SceneRun::Hooks hooks = {});
  /// The same with a setup loaded already, by load_setup for these options.
  LiveSession(std::shared_ptr<const RunSetup> setup, const RunOptions& options, bool repeat,
              SceneRun::Hooks hooks = {});
  ~LiveSession() override;

  /// Runs until the script ends (unless repeated) or `stop` becomes true; then retracts the devices
  /// and closes the recording; a scene that loads then is given up. Returns the summary of the last
  /// generation. Throws OperationError when the recording could not be written. Once.
  RunSummary run(const std::atomic<bool>& stop, const RunObserver& observer = {});

  std::shared_ptr<const SceneDescription> description() override;
  bool refresh() override;
  [[nodiscard]] const Snapshot& latest() const override;
  void request(const LiveRequest& request) override;
  void offer_hand(const XrHand& hand) override;
  [[nodiscard]] std::string loading() override;
  /// What RunObserver::message gets.
  [[nodiscard]] std::optional<std::string> take_message() override;
  [[nodiscard]] std::optional<LiveEvent> take_event() override;
  [[nodiscard]] const RegistrationState& registration() const override;
  [[nodiscard]] FitState fit() override { return fit_.state(); }

 private:
  void begin(std::shared_ptr<const RunSetup> setup);
  void set_loading(std::string scene);
  /// The next one that can be obeyed now: none for a scene waits for the one that loads.
  bool take_request(LiveRequest& request);
  /// What is asked for until there is something to run next.
  std::shared_ptr<const RunSetup> obey_requests();
  /// Whether another scene was asked for than the one that loads.
  bool wants_another_scene();
  void hold(const LiveRequest& request);
  void release(const LiveRequest& request);
  void begin_registration(const LiveRequest& request);
  void lead(const LiveRequest& request);
  void await_fit(const LiveRequest& request);
  /// In place of a run; the same scene follows, with what was learned.
  void fit_device(const std::atomic<bool>& stop, const RunObserver& observer);
  [[nodiscard]] bool has_scene(const std::string& name) const;
  void begin_loading(const std::filesystem::path& scene);
  /// The scene that was loaded; null: none, or not yet, or it cannot be, which is told.
  std::shared_ptr<const RunSetup> take_loaded(const RunObserver& observer);

  RunOptions options_;
  bool repeat_;
  SceneRun::Hooks hooks_;
  std::vector<std::string> scene_names_;
  std::uint64_t generation_ = 0;
  std::shared_ptr<const RunSetup> setup_;
  std::unique_ptr<SceneLoad> load_;  ///< null: no scene loads
  bool fit_awaited_ = false;         ///< the run that ends makes room for a fit

  // Between the viewer's thread and the session's; the loops never take it.
  std::mutex mutex_;
  std::shared_ptr<SceneRun> run_;
  std::shared_ptr<const SceneDescription> description_;
  std::vector<LiveRequest> requests_;
  std::deque<std::string> messages_;  ///< for the page
  std::string loading_;               ///< see LiveFeed
  // Viewer's thread only: keeps the mailbox alive that latest() points into.
  std::shared_ptr<SceneRun> viewed_;
  LiveRegistration registration_;
  LiveFit fit_;
};

}  // namespace softfinger
