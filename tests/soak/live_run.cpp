#include "live_run.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <thread>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "largest_file.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/natnet/natnet_emulator.hpp"
#include "softfinger/viewer/server.hpp"
#include "step_times.hpp"
#include "stolen_time.hpp"
#include "visitors.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRoom = 16 << 20;  // bytes of a disk that fills: a second of whole states
constexpr double kMayBeLost = 0.2;       // s
constexpr double kThere = 0.5 * deg;

/// Where the servos were, 200 times a second.
class Observation {
 public:
  struct Sample {
    double time = 0.0;  ///< s on the monotonic clock
    JointAngles joints;
  };
  explicit Observation(const TroubledBoard& board)
      : thread_([this, &board] {
          while (!ending_) {
            samples_.push_back({monotonic_time(), board.standing()});
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
          }
        }) {}
  ~Observation() { (void)end(); }
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

  const std::vector<Sample>& end() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    return samples_;
  }

 private:
  std::vector<Sample> samples_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

/// From the commands of the last second, for nine tenths of it.
std::optional<double> behind(const TroubledBoard& board, const std::vector<TickRecord>& ticks,
                             const std::vector<Observation::Sample>& observed,
                             std::span<const double> step_times) {
  const double end = step_times.back();
  std::vector<double> apart;
  for (const Observation::Sample& sample : observed) {
    if (sample.time < end - 1.0 || sample.time > end) continue;
    const auto later = std::ranges::find_if(ticks, [&](const TickRecord& tick) {
      return step_times[static_cast<std::size_t>(std::max<std::int64_t>(tick.step, 1) - 1)] >
             sample.time;
    });
    if (later == ticks.begin() || (later == ticks.end() && ticks.empty())) continue;
    const TickRecord& tick = *std::prev(later);
    const double commanded =
        step_times[static_cast<std::size_t>(std::max<std::int64_t>(tick.step, 1) - 1)];
    if (sample.time - commanded > 0.2) continue;  // not recorded
    apart.push_back(board.away_from(sample.joints, tick.command.joints));
  }
  if (apart.empty()) return std::nullopt;
  return quantile(apart, 0.9);
}

/// From `since` (s on the monotonic clock) until the servos stood there for good.
double time_to(const JointAngles& there, const TroubledBoard& board,
               const std::vector<Observation::Sample>& observed, double since) {
  if (observed.empty()) return std::numeric_limits<double>::infinity();
  const auto elsewhere = std::find_if(observed.rbegin(), observed.rend(), [&](const auto& sample) {
    return board.away_from(sample.joints, there) > kThere;
  });
  if (elsewhere == observed.rbegin()) return std::numeric_limits<double>::infinity();
  return elsewhere == observed.rend() ? 0.0 : std::max(0.0, elsewhere->time - since);
}

RunOptions options_for(const LiveFault& fault, double seconds,
                       const TemporaryDirectory& directory) {
  RunOptions options;
  options.scene = fs::path(source_folder()) / "scenes/sphere.toml";
  if (!fault.device.empty()) {
    options.devices = {(fs::path(source_folder()) / "devices" / fault.device).string()};
  }
  options.duration = seconds;
  options.actuator.guard_program = guard_program();
  options.actuator.port = (directory / "board").string();
  options.recording = directory / "run.db";
  options.record_state = fault.disk_fills;
  return options;
}

void read_recording(const RunOptions& options, LiveOutcome& outcome,
                    std::vector<TickRecord>& ticks) {
  RecordingReader reader(*options.recording);
  StepRecord step;
  while (reader.next(step)) {
    if (step.step != outcome.recorded) break;  // one is missing
    ++outcome.recorded;
    if (step.step > 0) outcome.step_time.push_back(step.wall_time);
  }
  TickRecord tick;
  while (reader.next(tick)) ticks.push_back(tick);
}

}  // namespace

LiveOutcome run_live(const LiveFault& fault, double seconds) {
  const TemporaryDirectory directory;
  RunOptions options = options_for(fault, seconds, directory);
  const std::shared_ptr<const Device> device = load_setup(options)->devices.at(0);
  TroubledBoard board(device, options.actuator.port);

  std::unique_ptr<NatNetEmulator> natnet;
  std::unique_ptr<PoseSender> sender;
  if (fault.natnet) {
    natnet = std::make_unique<NatNetEmulator>(
        NatNetEmulator::Options{.rate = 120.0, .loss = 0.3, .duplication = 0.1, .reordering = 0.2},
        [](double time) { return TrackedPose{.X_WFt = soaked_finger(time), .valid = true}; });
    options.trackers = {"natnet:" + text_of(natnet->address()) + ",body=index"};
  } else {
    const std::uint16_t port = UdpSocket({kLoopback, 0}).local().port;
    options.trackers = {"udp:" + std::to_string(port)};
    sender = std::make_unique<PoseSender>(port, fault.poses);
  }

  StepTimes times(static_cast<std::size_t>(1.5e3 * seconds));
  LiveOutcome outcome;
  const StolenTime stolen;
  double reached = 0.0;
  double disk_full_at = seconds;
  RunObserver observer;
  observer.progress = [&](double time, std::optional<double>) { reached = time; };
  observer.message = [&](const std::string& line) {
    outcome.messages.push_back(line);
    if (fault.disk_fills && disk_full_at == seconds) disk_full_at = reached;
  };
  LiveSession session(options, false, {.on_step = [&times] { times.note(); }});
  auto server = std::make_unique<Server>(session, ServerOptions{.port = 0});
  Watcher watcher(server->port());
  std::unique_ptr<Visitors> visitors;
  if (fault.crowd) visitors = std::make_unique<Visitors>(server->port());
  Observation observation(board);
  std::atomic<bool> ended{false};
  const double steps = 1e3 * seconds;
  double over = 0.0;
  std::thread trouble([&] {
    if (!fault.board) return;
    fault.board(board, [&](double share) {
      while (!ended && static_cast<double>(std::ssize(times.times())) < share * steps) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      return !ended;
    });
    over = monotonic_time();
  });
  const std::atomic<bool> stop{false};
  try {
    std::optional<LargestFile> full_disk;
    if (fault.disk_fills) full_disk.emplace(kRoom);
    outcome.deadline_misses = session.run(stop, observer).deadline_misses;
  } catch (const OperationError& error) {
    outcome.messages.emplace_back(error.what());
  }
  ended = true;
  trouble.join();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // for the servos to get there
  const auto& observed = observation.end();
  JointAngles retracted;
  (void)device->inverse_kinematics(device->retracted(), retracted);
  outcome.stolen = stolen.share();
  outcome.unretracted = board.away_from(board.standing(), retracted);
  const double end = times.times().empty() ? 0.0 : times.times().back();
  outcome.retracted_in = time_to(retracted, board, observed, fault.stops ? over : end);
  outcome.held_back = board.line().most_waiting();
  if (fault.holds_back) outcome.replayed = board.maestro().most_at_once();
  if (visitors) outcome.visitors = visitors->came();
  visitors.reset();
  server.reset();
  watcher.join();
  outcome.pictures = watcher.pictures();
  outcome.longest_gap = watcher.longest_gap();

  outcome.steps = std::ssize(times.times());
  outcome.rate = times.rate();
  outcome.lateness = times.lateness(1e-3);
  std::vector<TickRecord> ticks;
  read_recording(options, outcome, ticks);
  const double due =
      fault.disk_fills ? disk_full_at - kMayBeLost : 1e-3 * static_cast<double>(outcome.steps + 1);
  outcome.missing =
      std::max<std::int64_t>(0, static_cast<std::int64_t>(1e3 * due + 0.5) - outcome.recorded);
  if (!times.times().empty()) outcome.behind = behind(board, ticks, observed, times.times());
  return outcome;
}

}  // namespace softfinger
