#include "softfinger/tracking/natnet/natnet_emulator.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/up_axis.hpp"

namespace softfinger {
namespace {

constexpr std::uint64_t kTicksPerSecond = 10'000'000;
constexpr std::int32_t kBodyId = 7;
constexpr double kClientTimeout = 5.0;  // s without a word of a unicast client
constexpr std::size_t kMostClients = 8;

/// "Bitstream,4.1": the version; none where it is not that.
std::optional<NatNetVersion> asked_version(std::string_view text) {
  constexpr std::string_view kCommand = "Bitstream,";
  if (!text.starts_with(kCommand)) return std::nullopt;
  text.remove_prefix(kCommand.size());
  NatNetVersion version;
  const char* const end = text.data() + text.size();
  const auto major = std::from_chars(text.data(), end, version.major);
  if (major.ec != std::errc() || major.ptr == end || *major.ptr != '.') return std::nullopt;
  const auto minor = std::from_chars(major.ptr + 1, end, version.minor);
  if (minor.ec != std::errc()) return std::nullopt;
  return version;
}

}  // namespace

NatNetEmulator::NatNetEmulator(Options options, Motion motion)
    : options_(std::move(options)),
      motion_(std::move(motion)),
      command_({options_.address, options_.port}),
      data_({options_.address, 0}),
      version_(options_.version),
      // The body is neither the first nor the only one.
      bodies_{{1, options_.body + " (another)"}, {kBodyId, options_.body}},
      random_(options_.seed) {
  self_ = {.name = "softfinger emulator",
           .version = options_.version,
           .ticks_per_second = kTicksPerSecond,
           // Nobody else can have the port that frames come from.
           .data_port = options_.to_data_port ? UdpSocket({options_.address, 0}).local().port
                                              : data_.local().port,
           .multicast = options_.multicast,
           .group = options_.group};
  if (options_.multicast) data_.send_multicast_from(options_.address);
  thread_ = std::thread([this] { serve(); });
}

NatNetEmulator::~NatNetEmulator() {
  ending_ = true;
  thread_.join();
}

std::uint64_t NatNetEmulator::ticks(double now) const {
  return static_cast<std::uint64_t>((now + options_.clock_ahead) *
                                    static_cast<double>(kTicksPerSecond));
}

bool NatNetEmulator::happens(double probability) {
  return probability > 0.0 && std::uniform_real_distribution<double>()(random_) < probability;
}

void NatNetEmulator::serve() {
  constexpr double kLookUpEvery = 0.05;  // s
  std::vector<std::uint8_t> buffer(kLargestDatagram);
  const std::array<int, 1> sockets{command_.descriptor()};
  while (!ending_.load(std::memory_order_relaxed)) {
    const double left = began_ ? next_frame_ - monotonic_time() : kLookUpEvery;
    wait_for_datagram(sockets, std::min(left, kLookUpEvery));
    while (const auto datagram = command_.receive(buffer)) {
      answer(std::span(buffer).first(datagram->size), datagram->from, monotonic_time());
    }
    const double now = monotonic_time();
    if (!began_ || now < next_frame_) continue;
    // Frames that could not be sent in time are skipped, as by cameras.
    const double period = 1.0 / options_.rate;
    next_frame_ = std::max(next_frame_ + period, now - period);
    send_frame(now);
  }
}

void NatNetEmulator::hear(const Endpoint& client, double now) {
  const auto known = std::ranges::find(clients_, client, &Client::place);
  if (known != clients_.end()) {
    known->heard = now;
  } else if (clients_.size() < kMostClients) {
    clients_.push_back({client, now});
  }
}

void NatNetEmulator::answer(std::span<const std::uint8_t> datagram, const Endpoint& from,
                            double now) {
  const auto packet = open_natnet(datagram);
  if (!packet) return;
  switch (packet->message) {
    case NatNetMessage::kConnect:
      hear(from, now);
      if (!began_) {
        began_ = now;
        next_frame_ = now;
      }
      command_.send(from, encode_natnet_server(self_));
      break;
    case NatNetMessage::kRequestModels:
      command_.send(from, encode_natnet_models(bodies_, version_, true));
      break;
    case NatNetMessage::kRequest: {
      const std::string_view text(reinterpret_cast<const char*>(packet->payload.data()),
                                  packet->payload.size());
      const auto version = asked_version(text);
      const bool possible = version && !options_.multicast && *version >= kOldestNatNet &&
                            *version <= std::min(options_.version, kNewestNatNet);
      if (possible) version_ = *version;
      command_.send(from, encode_natnet_response(possible ? 0 : 1));
      break;
    }
    case NatNetMessage::kKeepAlive:
      hear(from, now);
      break;
    case NatNetMessage::kEchoRequest:
      // The request has the stamp alone.
      if (packet->payload.size() == 8) {
        std::array<std::uint8_t, 16> both{};
        std::copy(packet->payload.begin(), packet->payload.end(), both.begin());
        const auto echo = decode_natnet_echo(both);
        command_.send(from, encode_natnet_echo({echo->stamp, ticks(now)}));
      }
      break;
    default:
      break;
  }
}

void NatNetEmulator::send_frame(double now) {
  const double exposed = now - options_.exposure_age;
  time_.store(now - *began_, std::memory_order_relaxed);
  const TrackedPose pose = motion_(std::max(0.0, exposed - *began_));
  Pose X_KBody = tracker_from_world(options_.up, pose.X_WFt);
  X_KBody.translation /= options_.scale;
  const std::array<NatNetBodyPose, 2> bodies{
      NatNetBodyPose{.id = bodies_[0].id, .X_KBody = {}, .tracked = true},
      NatNetBodyPose{.id = bodies_[1].id, .X_KBody = X_KBody, .tracked = pose.valid}};
  NatNetDatagram frame = encode_natnet_frame({.number = ++number_,
                                              .bodies = bodies,
                                              .time = now - *began_,
                                              .mid_exposure = ticks(exposed),
                                              .received = ticks(exposed),
                                              .transmitted = ticks(now),
                                              .with_all_sections = true},
                                             version_);
  if (options_.mute || happens(options_.loss)) return;
  if (happens(options_.reordering)) {
    held_back_.push_back(std::move(frame));
    return;
  }
  send_to_clients(frame, now);
  if (happens(options_.duplication)) send_to_clients(frame, now);
  for (const NatNetDatagram& late : held_back_) send_to_clients(late, now);
  held_back_.clear();
}

void NatNetEmulator::send_to_clients(std::span<const std::uint8_t> datagram, double now) {
  if (options_.multicast) {
    data_.send({options_.group, self_.data_port}, datagram);
  } else {
    std::erase_if(clients_, [&](const Client& c) { return now - c.heard > kClientTimeout; });
    for (const Client& client : clients_) {
      const std::uint16_t port = options_.to_data_port ? self_.data_port : client.place.port;
      data_.send({client.place.address, port}, datagram);
    }
  }
}

}  // namespace softfinger
