#include "softfinger/tracking/natnet/natnet_tracker.hpp"

#include <fmt/format.h>

#include <array>

#include "softfinger/base/error.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr double kWait = 0.01;         // s, for a datagram, before what is due is sent
constexpr int kMostAtOnce = 64;        // datagrams of a socket between two looks at the clock
constexpr std::size_t kMostNames = 8;  // of bodies in a message

bool is_multicast(std::uint32_t address) { return address >> 28 == 0xe; }

std::string names_of(const std::vector<NatNetBody>& bodies) {
  std::string names;
  for (std::size_t i = 0; i < bodies.size() && i < kMostNames; ++i) {
    names += (i == 0 ? "" : ", ") + bodies[i].name;
  }
  if (bodies.size() > kMostNames) names += ", ...";
  return names;
}

}  // namespace

NatNetTracker::NatNetTracker(const TrackerSpec& spec, double patience, const Pose& start)
    : spec_(spec),
      server_{find_address(spec.address), spec.port},
      interface_(local_address_towards(server_.address)),
      command_({interface_, 0}),
      feed_(start),
      session_(spec, feed_),
      buffer_(kLargestDatagram) {
  connect(patience);
  thread_ = std::thread([this] { serve(); });
}

NatNetTracker::~NatNetTracker() {
  ending_ = true;
  thread_.join();
}

TrackedPose NatNetTracker::sample(double time) { return feed_.sample(time, monotonic_time()); }

void NatNetTracker::connect(double patience) {
  NatNetStage stage = NatNetStage::kNoAnswer;
  double since = monotonic_time();
  while (stage != NatNetStage::kStreaming) {
    if (session_.server() != nullptr) open_data_socket();
    exchange();
    const double now = monotonic_time();
    const NatNetStage reached = session_.stage(now);
    if (reached != stage) since = now;
    stage = reached;
    if (stage == NatNetStage::kNoSuchBody || now - since > patience) {
      throw InputError(obstacle(stage));
    }
  }
}

void NatNetTracker::serve() {
  while (!ending_.load(std::memory_order_relaxed)) {
    try {
      if (session_.server() != nullptr) open_data_socket();
    } catch (const std::exception&) {
      // The interface is gone, perhaps for a while: no frames, which stage() will say.
    }
    exchange();
    stage_.store(session_.stage(monotonic_time()), std::memory_order_relaxed);
  }
}

void NatNetTracker::exchange() {
  const std::array<int, 2> sockets{command_.descriptor(), data_ ? data_->descriptor() : -1};
  wait_for_datagram(sockets, kWait);
  receive_from(command_);
  if (data_) receive_from(*data_);
  session_.send_due(monotonic_time(), [this](std::span<const std::uint8_t> datagram) {
    command_.send(server_, datagram);
  });
}

void NatNetTracker::receive_from(UdpSocket& socket) {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const auto datagram = socket.receive(buffer_);
    if (!datagram) return;
    if (datagram->from.address == server_.address) {
      session_.receive(std::span(buffer_).first(datagram->size), monotonic_time());
    } else {
      stranger_ = datagram->from.address;
    }
  }
}

void NatNetTracker::open_data_socket() {
  const NatNetServer& server = *session_.server();
  Endpoint place{interface_, server.data_port};
  if (session_.multicast())
    place.address = is_multicast(server.group) ? server.group : kNatNetGroup;
  if (data_place_ == place) return;
  data_place_ = place;
  data_.reset();
  if (session_.multicast()) {
    data_.emplace(place, true);
    data_->join(place.address, interface_);
    return;
  }
  try {
    data_.emplace(place);
  } catch (const InputError&) {
    // Another client has the port: frames may still come to the command socket.
  }
}

std::string NatNetTracker::obstacle(NatNetStage stage) const {
  const std::string tracker = fmt::format("tracker natnet at {}: ", text_of(server_));
  switch (stage) {
    case NatNetStage::kNoAnswer:
      return tracker + fmt::format(
                           "the command socket is silent, nothing answers; is the server running "
                           "and streaming "
                           "on that address (in Motive: Local Interface), and does a firewall let "
                           "UDP port {} pass?",
                           server_.port);
    case NatNetStage::kOtherVersion:
      return tracker + fmt::format("the server speaks NatNet {}, this program {} to {}{}",
                                   text_of(session_.server()->version), text_of(kOldestNatNet),
                                   text_of(kNewestNatNet),
                                   session_.multicast()
                                       ? "; other versions can be asked for over unicast"
                                       : "");
    case NatNetStage::kNoModels:
      return tracker + "the server answers but does not say what it tracks";
    case NatNetStage::kNoSuchBody:
      return tracker + (session_.bodies().empty()
                            ? fmt::format("no rigid body '{}': the server tracks none", spec_.body)
                            : fmt::format("no rigid body '{}'; there are {}", spec_.body,
                                          names_of(session_.bodies())));
    case NatNetStage::kFramesUnread:
      return tracker + fmt::format("frames come, but not in the layout of NatNet {}",
                                   text_of(session_.server()->version));
    case NatNetStage::kNoFrames:
    case NatNetStage::kStreaming:
      break;
  }
  const std::string silent = tracker + "the server answers, but the data socket is silent";
  if (stranger_) {
    return silent + fmt::format("; frames come from {}, name that host", address_text(*stranger_));
  }
  const std::string place = data_place_ ? text_of(*data_place_) : "none";
  if (session_.multicast()) {
    return silent + fmt::format(
                        ": no multicast at {} on the interface of {}; is streaming on, from the "
                        "server's interface "
                        "on that network, and does every switch and firewall pass multicast? "
                        "unicast may help",
                        place, address_text(interface_));
  }
  return silent + fmt::format(
                      ": no frames by unicast at {}; is streaming on and set to unicast, and does "
                      "a firewall let "
                      "UDP pass?",
                      place);
}

std::optional<std::string> NatNetTracker::take_message() {
  const NatNetStage stage = stage_.load(std::memory_order_relaxed);
  // One line when frames stop and one when they come again, not each stage on the way.
  if ((stage == NatNetStage::kStreaming) == told_streaming_) return std::nullopt;
  told_streaming_ = !told_streaming_;
  const std::string tracker = fmt::format("tracker natnet at {}: ", text_of(server_));
  switch (stage) {
    case NatNetStage::kStreaming:
      return tracker + "frames come again";
    case NatNetStage::kNoAnswer:
      return tracker + "the server is silent";
    case NatNetStage::kNoSuchBody:
      return tracker + fmt::format("the server no longer tracks a rigid body '{}'", spec_.body);
    default:
      return tracker + "the server answers, but no frames come that could be read";
  }
}

}  // namespace softfinger
