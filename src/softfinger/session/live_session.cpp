#include "softfinger/session/live_session.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/session/scene_snapshot.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr auto kPollInterval = std::chrono::milliseconds(5);
/// More requests than this at a time are not from a person.
constexpr std::size_t kMostRequests = 32;
constexpr std::size_t kMostMessages = 32;  // that wait for the page

void observe(SceneRun& run, const RunObserver& observer) {
  while (const auto message = run.take_message()) {
    if (observer.message) observer.message(*message);
  }
  if (observer.progress) observer.progress(run.time(), run.duration());
}

std::vector<std::string> scenes_beside(const fs::path& scene) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::path directory = scene.has_parent_path() ? scene.parent_path() : fs::path(".");
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool changes_scene(LiveRequest::Kind kind) {
  return kind == LiveRequest::Kind::kRestart || kind == LiveRequest::Kind::kScene ||
         kind == LiveRequest::Kind::kReload;
}

/// "run.db" for generation 1, "run-2.db" for generation 2.
fs::path recording_of(const fs::path& file, std::uint64_t generation) {
  if (generation == 1) return file;
  fs::path numbered = file;
  numbered.replace_filename(
      fmt::format("{}-{}{}", file.stem().string(), generation, file.extension().string()));
  return numbered;
}

}  // namespace

RunSummary run_headless(const RunOptions& options, const std::atomic<bool>& stop,
                        const RunObserver& observer, SceneRun::Hooks hooks) {
  std::shared_ptr<const RunSetup> setup = load_unless_stopped(options, stop);
  if (!setup) return {};
  return run_headless(std::move(setup), options, stop, observer, std::move(hooks));
}

RunSummary run_headless(std::shared_ptr<const RunSetup> setup, const RunOptions& options,
                        const std::atomic<bool>& stop, const RunObserver& observer,
                        SceneRun::Hooks hooks) {
  SceneRun run(std::move(setup), options, SceneRun::Mode::kHeadless, 1, std::move(hooks));
  run.start();
  while (!run.ended()) {
    if (stop.load()) run.stop();
    observe(run, observer);
    std::this_thread::sleep_for(kPollInterval);
  }
  observe(run, observer);
  RunSummary summary = run.finish();
  observe(run, observer);
  return summary;
}

LiveSession::LiveSession(const RunOptions& options, bool repeat, SceneRun::Hooks hooks)
    : LiveSession(load_setup(options), options, repeat, std::move(hooks)) {}

LiveSession::LiveSession(std::shared_ptr<const RunSetup> setup, const RunOptions& options,
                         bool repeat, SceneRun::Hooks hooks)
    : options_(options),
      repeat_(repeat),
      hooks_(std::move(hooks)),
      scene_names_(scenes_beside(options.scene)) {
  begin(std::move(setup));
  viewed_ = run_;
}

LiveSession::~LiveSession() = default;

void LiveSession::begin(std::shared_ptr<const RunSetup> setup) {
  ++generation_;
  const bool described = setup == setup_;  // a restart
  setup_ = std::move(setup);
  RunOptions options = options_;
  if (options.recording) options.recording = recording_of(*options.recording, generation_);
  auto run =
      std::make_shared<SceneRun>(setup_, options, SceneRun::Mode::kLive, generation_, hooks_);
  auto description =
      std::make_shared<SceneDescription>(described ? *description_ : describe(*setup_));
  description->generation = generation_;
  description->scene_names = scene_names_;
  description->duration = run->duration().value_or(0.0);
  if (!description->fingers.empty()) {
    description->fingers[0].twin = options_.twin && setup_->devices[0];
  }
  const std::lock_guard lock(mutex_);
  if (run_) run->continue_after(*run_);
  loading_.clear();
  run_ = std::move(run);
  description_ = std::move(description);
}

bool LiveSession::take_request(LiveRequest& request) {
  const std::lock_guard lock(mutex_);
  const auto next = std::ranges::find_if(
      requests_, [&](const LiveRequest& each) { return !load_ || !changes_scene(each.kind); });
  if (next == requests_.end()) return false;
  request = *next;
  requests_.erase(next);
  return true;
}

bool LiveSession::wants_another_scene() {
  const std::lock_guard lock(mutex_);
  const auto last = std::find_if(requests_.rbegin(), requests_.rend(), [](const LiveRequest& each) {
    return each.kind == LiveRequest::Kind::kScene;
  });
  return last != requests_.rend() && last->scene != loading_ && has_scene(last->scene);
}

RunSummary LiveSession::run(const std::atomic<bool>& stop, const RunObserver& told) {
  RunObserver observer = told;
  observer.message = [&](const std::string& line) {
    if (told.message) told.message(line);
    const std::lock_guard lock(mutex_);
    if (messages_.size() < kMostMessages) messages_.push_back(line);
  };
  RunSummary summary;
  bool again = true;
  while (again) {
    again = false;
    run_->start();
    std::shared_ptr<const RunSetup> next;
    const auto begin_anew = [&] {
      if (next || load_ || fit_awaited_ || !repeat_ || stop.load()) return;
      next = setup_;
      set_loading(setup_->scene.file.stem().string());
    };
    while (!run_->ended()) {
      observe(*run_, observer);
      if (stop.load()) {
        run_->stop();
        if (load_) load_->give_up();
      }
      if (!next) next = take_loaded(observer);
      if (!next) next = obey_requests();
      if (next) run_->stop();
      std::this_thread::sleep_for(kPollInterval);
    }
    begin_anew();
    observe(*run_, observer);
    summary = run_->finish();
    observe(*run_, observer);
    const bool fitted = std::exchange(fit_awaited_, false) && !stop.load();
    if (fitted) fit_device(stop, observer);
    // A script may end while the scene that is to follow loads.
    while (load_ && !stop.load()) {
      next = take_loaded(observer);
      if (!next && !load_) next = obey_requests();  // a newer one may wait
      std::this_thread::sleep_for(kPollInterval);
    }
    if (!next && fitted) next = setup_;  // nothing was learned, or it cannot be read
    begin_anew();
    if (next && !stop.load()) {
      begin(std::move(next));
      again = true;
    }
  }
  load_.reset();  // the devices have retracted: what is left of it may take its time
  return summary;
}

std::shared_ptr<const RunSetup> LiveSession::obey_requests() {
  LiveRequest request;
  while (take_request(request)) {
    switch (request.kind) {
      case LiveRequest::Kind::kPause:
        run_->set_paused(true);
        break;
      case LiveRequest::Kind::kResume:
        run_->set_paused(false);
        break;
      case LiveRequest::Kind::kRestart:
        set_loading(setup_->scene.file.stem().string());
        return setup_;
      case LiveRequest::Kind::kScene:
        if (has_scene(request.scene)) {
          begin_loading(options_.scene.parent_path() / (request.scene + ".toml"));
        }
        break;
      case LiveRequest::Kind::kObjective:
        lead(request);
        break;
      case LiveRequest::Kind::kReload:
        begin_loading(setup_->scene.file);
        break;
      case LiveRequest::Kind::kFit:
        await_fit(request);
        break;
      case LiveRequest::Kind::kPose:
      case LiveRequest::Kind::kHold:
      case LiveRequest::Kind::kLetGo:
      case LiveRequest::Kind::kCancelFit:
      case LiveRequest::Kind::kFelt:
      case LiveRequest::Kind::kStop:
      case LiveRequest::Kind::kRelease:
      case LiveRequest::Kind::kRegister:
      case LiveRequest::Kind::kCancelRegistration:
        break;  // went straight to the run, to the registration or to the fit
    }
  }
  return nullptr;
}

/// As the page may ask: of a finger with a device that can have it.
void LiveSession::lead(const LiveRequest& request) {
  const ObjectiveKind* const kind = objective_kind(request.objective);
  if (kind == nullptr || request.finger >= setup_->devices.size()) return;
  const Device* const device = setup_->devices[request.finger].get();
  if (device != nullptr && why_not(*kind, *device).empty()) run_->lead_by(request.finger, *kind);
}

/// Devices retract, and stay so when all is done until somebody releases them, as of a
/// registration.
void LiveSession::await_fit(const LiveRequest& request) {
  if (load_ || fit_awaited_ || !is_fittable(*setup_, request.finger)) return;
  fit_awaited_ = true;
  fit_.await(request, options_);
  const std::lock_guard lock(mutex_);
  run_->stop_devices(StopCause::kRun);
  run_->stop();
}

void LiveSession::fit_device(const std::atomic<bool>& stop, const RunObserver& observer) {
  if (fit_.run(*setup_, options_, stop, observer)) begin_loading(setup_->scene.file);
}

bool LiveSession::has_scene(const std::string& name) const {
  return std::ranges::find(scene_names_, name) != scene_names_.end();
}

void LiveSession::begin_loading(const fs::path& scene) {
  set_loading(scene.stem().string());
  RunOptions options = options_;
  options.scene = scene;
  load_ = std::make_unique<SceneLoad>(options);
}

std::shared_ptr<const RunSetup> LiveSession::take_loaded(const RunObserver& observer) {
  if (!load_) return nullptr;
  if (wants_another_scene()) load_->give_up();
  if (!load_->done()) return nullptr;
  const std::unique_ptr<SceneLoad> load = std::move(load_);
  if (load->given_up()) {
    set_loading("");
    return nullptr;
  }
  try {
    return load->take();
  } catch (const InputError& error) {
    observer.message(error.what());
  } catch (const OperationError& error) {
    observer.message(error.what());
  }
  set_loading("");
  return nullptr;
}

void LiveSession::set_loading(std::string scene) {
  const std::lock_guard lock(mutex_);
  loading_ = std::move(scene);
}

std::string LiveSession::loading() {
  const std::lock_guard lock(mutex_);
  return loading_;
}

std::shared_ptr<const SceneDescription> LiveSession::description() {
  const std::lock_guard lock(mutex_);
  return description_;
}

bool LiveSession::refresh() {
  bool changed = false;
  {
    const std::lock_guard lock(mutex_);
    changed = viewed_ != run_;
    viewed_ = run_;
  }
  const bool fresh = viewed_->snapshots().refresh() || changed;
  if (fresh && registration_.take(latest())) {
    LiveRequest reload;
    reload.kind = LiveRequest::Kind::kReload;
    request(reload);
  }
  return fresh;
}

std::optional<std::string> LiveSession::take_message() {
  const std::lock_guard lock(mutex_);
  if (messages_.empty()) return std::nullopt;
  std::string message = std::move(messages_.front());
  messages_.pop_front();
  return message;
}

std::optional<LiveEvent> LiveSession::take_event() {
  const std::optional<EventRecord> event = viewed_->take_event();
  if (!event) return std::nullopt;
  const std::vector<std::string> names = names_in_events(viewed_->setup());
  const auto name = [&](std::int64_t number) {
    return number < 0 ? std::string() : names[static_cast<std::size_t>(number)];
  };
  return LiveEvent{event->time, kEventKinds[static_cast<std::size_t>(event->kind)],
                   name(event->object), name(event->other), event->impulse};
}

const RegistrationState& LiveSession::registration() const { return registration_.state(); }

// Devices retract, and stay so when all is done until somebody releases them: the finger is on a
// table.
void LiveSession::begin_registration(const LiveRequest& wanted) {
  if (!registration_.begin(wanted, viewed_->setup(), latest().generation)) return;
  {
    const std::lock_guard lock(mutex_);
    run_->stop_devices(StopCause::kRun);
  }
  LiveRequest resume;
  resume.kind = LiveRequest::Kind::kResume;
  request(resume);
}

const Snapshot& LiveSession::latest() const { return viewed_->snapshots().latest(); }

void LiveSession::request(const LiveRequest& request) {
  if (request.kind == LiveRequest::Kind::kPose) {
    viewed_->offer_pose(request.finger, request.X_W);
    return;
  }
  if (request.kind == LiveRequest::Kind::kHold || request.kind == LiveRequest::Kind::kLetGo) {
    return hold(request);
  }
  if (request.kind == LiveRequest::Kind::kRegister) return begin_registration(request);
  if (request.kind == LiveRequest::Kind::kCancelRegistration) return registration_.cancel();
  if (request.kind == LiveRequest::Kind::kCancelFit) return fit_.cancel();
  if (request.kind == LiveRequest::Kind::kFelt) return fit_.tell_touch();
  if (request.kind == LiveRequest::Kind::kStop) fit_.stop_device();
  const std::lock_guard lock(mutex_);
  if (request.kind == LiveRequest::Kind::kStop) return run_->stop_devices(StopCause::kPerson);
  if (request.kind == LiveRequest::Kind::kRelease) return release(request);
  if (requests_.size() < kMostRequests) requests_.push_back(request);
}

/// By name: what comes late may be meant for the scene before.
void LiveSession::hold(const LiveRequest& request) {
  const std::vector<VirtualObject>& objects = viewed_->setup().scene.objects;
  const auto object = std::ranges::find(objects, request.object, &VirtualObject::name);
  if (object == objects.end()) return;
  const auto number = static_cast<std::size_t>(object - objects.begin());
  if (request.kind == LiveRequest::Kind::kHold) {
    viewed_->hold(number, request.X_W);
  } else {
    viewed_->let_go(number);
  }
}

/// With the lock.
void LiveSession::release(const LiveRequest& request) {
  const bool registering = registration_.state().phase == RegistrationState::Phase::kRunning;
  const bool fitting = fit_.state().is_under_way();
  const bool seen =
      request.generation == description_->generation && request.stops == run_->stops();
  if (registering || fitting || !seen || !run_->ask_release(request.stops, StopCause::kPerson)) {
    if (messages_.size() >= kMostMessages) return;
    messages_.push_back(registering ? "the device is not released: a finger is being registered"
                        : fitting   ? "the device is not released: it learns its wearer"
                                    : "the device is not released: it was stopped again");
  }
}

void LiveSession::offer_hand(const XrHand& hand) { viewed_->offer_hand(hand); }

}  // namespace softfinger
