#include "softfinger/tracking/natnet/natnet_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/tracking/stream/pose_message.hpp"
#include "softfinger/tracking/up_axis.hpp"

namespace softfinger {
namespace {

constexpr double kAskAgain = 0.25;        // s, for what has not been answered
constexpr double kEchoEvery = 0.5;        // s
constexpr double kFirstEchoEvery = 0.02;  // s, until there are a few to choose from
constexpr int kFirstEchoes = 8;
constexpr double kKeepAliveEvery = 0.5;  // s
constexpr double kModelsEvery = 1.0;     // s, where the server keeps saying that they changed
constexpr double kSilent = 2.0;          // s, after which a socket counts as silent
constexpr double kOldestExposure = 1.0;  // s; beyond, a stamp is no time of exposure
constexpr double kNanosecond = 1e-9;

bool is_due(double& due, double now, double interval) {
  if (now < due) return false;
  due = now + interval;
  return true;
}

}  // namespace

bool NatNetSession::multicast() const {
  return spec_.multicast.value_or(server_ && server_->multicast);
}

bool NatNetSession::version_is_known() const {
  return version_ >= kOldestNatNet && version_ <= kNewestNatNet;
}

void NatNetSession::receive(std::span<const std::uint8_t> datagram, double now) {
  const auto packet = open_natnet(datagram);
  if (!packet) return;
  if (packet->message == NatNetMessage::kServerInfo) {
    if (const auto server = decode_natnet_server(packet->payload)) {
      answered_ = now;
      take_server(*server);
    }
    return;
  }
  if (!server_) return;  // whose version is not known, nothing can be read of
  switch (packet->message) {
    case NatNetMessage::kResponse:
      answered_ = now;
      if (!version_is_known() && packet->payload.size() >= 4) {
        const bool done = std::ranges::all_of(packet->payload.first(4),
                                              [](std::uint8_t byte) { return byte == 0; });
        if (done && server_->version > kNewestNatNet) version_ = kNewestNatNet;
      }
      break;
    case NatNetMessage::kModels:
      answered_ = now;
      if (!version_is_known()) break;
      if (auto bodies = decode_natnet_models(packet->payload, version_)) {
        take_models(std::move(*bodies), now);
      }
      break;
    case NatNetMessage::kEchoResponse:
      if (const auto echo = decode_natnet_echo(packet->payload)) {
        const double sent = static_cast<double>(echo->stamp) * kNanosecond;
        if (sent > now || now - sent > kSilent) break;  // not of ours
        answered_ = now;
        clock_.add(sent, now, echo->ticks);
      }
      break;
    case NatNetMessage::kFrame:
      if (version_is_known()) take_frame(packet->payload, now);
      break;
    default:
      break;
  }
}

void NatNetSession::take_server(const NatNetServer& server) {
  const bool same = server_ && server_->version == server.version &&
                    server_->ticks_per_second == server.ticks_per_second;
  server_ = server;
  ask_server_ = false;
  if (same) return;
  version_ = server.version;
  models_known_ = false;
  echoes_ = 0;
  if (server.ticks_per_second > 0) clock_.reset(server.ticks_per_second);
}

void NatNetSession::take_models(std::vector<NatNetBody> bodies, double now) {
  models_known_ = true;
  models_came_ = now;
  bodies_ = std::move(bodies);
  const auto body = std::ranges::find(bodies_, spec_.body, &NatNetBody::name);
  body_.reset();
  if (body != bodies_.end()) body_ = body->id;
}

void NatNetSession::take_frame(std::span<const std::uint8_t> payload, double now) {
  if (!models_known_ && !body_) return;
  const auto frame = decode_natnet_frame(payload, version_, body_.value_or(0));
  if (!frame) {
    unread_came_ = now;
    ask_server_ = true;  // it may speak another version by now
    return;
  }
  frame_came_ = now;
  if (!gate_.admits(static_cast<std::uint32_t>(frame->number), now)) return;
  if (frame->version_changed) ask_server_ = true;
  if (frame->models_changed && now - models_came_ > kModelsEvery) models_known_ = false;
  if (!body_ || !frame->has_body || !frame->tracked) return feed_.lose();
  const auto X_KBody = pose_from_outside(spec_.scale * frame->position, frame->rotation);
  if (!X_KBody) return;
  double captured = clock_.local_time(frame->mid_exposure).value_or(now);
  if (std::abs(now - captured) > kOldestExposure) captured = now;
  feed_.offer(world_from_tracker(spec_.up, *X_KBody), captured, now);
}

void NatNetSession::send_due(double now, const Send& send) {
  // A server in the place of one that ended knows nothing of this client.
  if (now - answered_ > kSilent || now - frame_came_ > kSilent) ask_server_ = true;
  if (ask_server_ && is_due(connect_due_, now, kAskAgain)) send(encode_natnet_connect());
  if (!server_) return;
  if (!version_is_known()) {
    // A version for all would be asked for where all listen to one stream.
    if (server_->version > kNewestNatNet && !multicast() && is_due(version_due_, now, kAskAgain)) {
      send(encode_natnet_request(NatNetMessage::kRequest, "Bitstream," + text_of(kNewestNatNet)));
    }
    return;
  }
  if (!models_known_ && is_due(models_due_, now, kAskAgain)) {
    send(encode_natnet_request(NatNetMessage::kRequestModels));
  }
  if (is_due(echo_due_, now, echoes_ < kFirstEchoes ? kFirstEchoEvery : kEchoEvery)) {
    ++echoes_;
    send(encode_natnet_echo_request(static_cast<std::uint64_t>(now / kNanosecond)));
  }
  if (!multicast() && is_due(keep_alive_due_, now, kKeepAliveEvery)) {
    send(encode_natnet_request(NatNetMessage::kKeepAlive));
  }
}

NatNetStage NatNetSession::stage(double now) const {
  if (server_ && now - frame_came_ <= kSilent && body_) return NatNetStage::kStreaming;
  if (!server_ || now - answered_ > kSilent) return NatNetStage::kNoAnswer;
  if (!version_is_known()) return NatNetStage::kOtherVersion;
  if (!models_known_ && bodies_.empty()) return NatNetStage::kNoModels;
  if (!body_) return NatNetStage::kNoSuchBody;
  return now - unread_came_ <= kSilent ? NatNetStage::kFramesUnread : NatNetStage::kNoFrames;
}

}  // namespace softfinger
