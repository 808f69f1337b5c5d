#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "commands.hpp"
#include "port_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/recorded_poses.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/natnet/natnet_emulator.hpp"
#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "stop_signal.hpp"

namespace {

using namespace softfinger;

struct EmulateFlags {
  std::string file, finger;
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;
  double rate_Hz = 240.0;
  bool repeat = false;
  std::string body = "index";
  std::string version = "4.1";
  std::string up = "y";
  bool multicast = false;
};

/// The poses of the file over time, from 0; over and over with --repeat.
class Motion {
 public:
  explicit Motion(const EmulateFlags& flags)
      : poses_(read_poses(flags.file, flags.finger)), repeat_(flags.repeat) {
    if (!(flags.rate_Hz >= 1.0 && flags.rate_Hz <= 10000.0)) {
      throw InputError(fmt::format("--rate-Hz {}: must be 1 to 10000", flags.rate_Hz));
    }
  }
  TrackedPose sample(double time) {
    const double end = *poses_.end_time();
    return poses_.sample(repeat_ && end > 0.0 ? std::fmod(time, end) : time);
  }
  /// The last pose is sent for a little longer, so that it is not lost on its way.
  [[nodiscard]] bool ended(double time) const {
    constexpr double kAfterwards = 0.1;  // s
    return !repeat_ && time > *poses_.end_time() + kAfterwards;
  }

 private:
  CsvTracker poses_;
  bool repeat_;
};

void say(const std::string& line) {
  fmt::print("softfinger: {} (Ctrl-C ends)\n", line);
  std::fflush(stdout);
}

NatNetVersion read_version(const std::string& text) {
  for (const NatNetVersion version : {NatNetVersion{3, 0}, NatNetVersion{3, 1}, NatNetVersion{4, 0},
                                      NatNetVersion{4, 1}, NatNetVersion{4, 2}}) {
    if (text == text_of(version)) return version;
  }
  throw InputError(fmt::format("--version {}: known are 3.0, 3.1, 4.0, 4.1 and 4.2", text));
}

void emulate_natnet(const EmulateFlags& flags) {
  if (flags.up != "y" && flags.up != "z") {
    throw InputError(fmt::format("--up {}: must be y or z", flags.up));
  }
  if (flags.body.empty() || flags.body.size() > 255 || flags.body.find(',') != std::string::npos) {
    throw InputError(fmt::format(
        "--body '{}': expected a name of 1 to 255 characters without comma", flags.body));
  }
  Motion motion(flags);
  const std::atomic<bool>& stop = stop_on_signals();
  const NatNetEmulator emulator({.address = find_address(flags.address),
                                 .port = flags.port,
                                 .version = read_version(flags.version),
                                 .multicast = flags.multicast,
                                 .rate = flags.rate_Hz,
                                 .body = flags.body,
                                 .up = flags.up == "z" ? UpAxis::kZ : UpAxis::kY},
                                [&motion](double time) { return motion.sample(time); });
  say(fmt::format("NatNet {} at {}, rigid body '{}', {}", flags.version,
                  text_of(emulator.address()), flags.body,
                  flags.multicast ? "multicast" : "unicast"));
  while (!stop && !motion.ended(emulator.time())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

using Encode = std::function<std::vector<std::uint8_t>(const TrackedPose&, std::uint32_t)>;

/// Sends poses to a tracker that listens; `encode` gives no bytes where there is nothing to say.
void send_poses(const EmulateFlags& flags, const Encode& encode) {
  Motion motion(flags);
  const std::atomic<bool>& stop = stop_on_signals();
  const Endpoint listener{find_address(flags.address), flags.port};
  UdpSocket socket({local_address_towards(listener.address), 0});
  say(fmt::format("sends poses to {}", text_of(listener)));
  const double began = monotonic_time();
  std::uint32_t count = 0;
  while (!stop && !motion.ended(monotonic_time() - began)) {
    const std::vector<std::uint8_t> bytes =
        encode(motion.sample(monotonic_time() - began), ++count);
    if (!bytes.empty()) socket.send(listener, bytes);
    std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / flags.rate_Hz));
  }
}

void emulate_udp(const EmulateFlags& flags) {
  send_poses(flags, [](const TrackedPose& pose, std::uint32_t number) {
    const PoseDatagram datagram = encode_pose_datagram(
        {.X_WFt = pose.X_WFt, .valid = pose.valid, .sequence = number, .time = monotonic_time()});
    return std::vector<std::uint8_t>(datagram.begin(), datagram.end());
  });
}

void emulate_osc(const EmulateFlags& flags) {
  send_poses(flags, [](const TrackedPose& pose, std::uint32_t) {
    return pose.valid ? encode_osc_pose(pose.X_WFt, false) : std::vector<std::uint8_t>();
  });
}

/// A subcommand with the flags that all have.
CLI::App* add_peer(CLI::App& emulate, TrackerKind tracker, const char* what,
                   const std::shared_ptr<EmulateFlags>& flags) {
  CLI::App* command = emulate.add_subcommand(std::string(row_of(kTrackers, tracker).name), what);
  command->add_option("FILE", flags->file, "a recording, or a CSV file of poses")->required();
  command->add_option("--finger", flags->finger, "of a recording with several");
  command->add_option("--rate-Hz", flags->rate_Hz, "poses a second")->capture_default_str();
  command->add_flag("--repeat", flags->repeat, "start over at the end");
  return command;
}

}  // namespace

void add_emulate_command(CLI::App& app) {
  CLI::App* emulate = app.add_subcommand("emulate", "Be a tracker that streams what was recorded");
  emulate->require_subcommand(1);
  const auto natnet_flags = std::make_shared<EmulateFlags>();
  natnet_flags->port = kNatNetCommandPort;
  CLI::App* natnet = add_peer(*emulate, TrackerKind::kNatnet,
                              "An OptiTrack server with one rigid body that moves", natnet_flags);
  natnet->add_option("--address", natnet_flags->address, "own address")->capture_default_str();
  add_port_option(*natnet, "--port", natnet_flags->port, "of commands; 0: any free one");
  natnet->add_option("--body", natnet_flags->body, "name of the rigid body")->capture_default_str();
  natnet->add_option("--version", natnet_flags->version, "of NatNet, 3.0 to 4.2")
      ->capture_default_str();
  natnet->add_option("--up", natnet_flags->up, "axis that is up: y or z")->capture_default_str();
  natnet->add_flag("--multicast", natnet_flags->multicast,
                   "frames by multicast, not to each client");
  natnet->callback([natnet_flags] { emulate_natnet(*natnet_flags); });

  const auto add_sender = [&](TrackerKind tracker, const char* what,
                              void (*run)(const EmulateFlags&)) {
    const auto flags = std::make_shared<EmulateFlags>();
    CLI::App* sender = add_peer(*emulate, tracker, what, flags);
    sender->add_option("--address", flags->address, "of the tracker")->capture_default_str();
    add_port_option(*sender, "--port", flags->port, "that the tracker listens at", 1)
        ->default_str("")
        ->required();
    sender->callback([flags, run] { run(*flags); });
  };
  add_sender(TrackerKind::kUdp, "A sender of pose datagrams", emulate_udp);
  add_sender(TrackerKind::kOsc, "A sender of Open Sound Control", emulate_osc);
}
