#include "softfinger/session/event_sender.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "softfinger/base/error.hpp"
#include "softfinger/wire/endpoint.hpp"
#include "softfinger/wire/osc.hpp"

namespace softfinger {
namespace {

constexpr std::string_view kOsc = "osc:";
constexpr std::string_view kEventAddress = "/softfinger/event";

}  // namespace

EventSender::EventSender(std::string_view to, std::vector<std::string> names)
    : names_(std::move(names)) {
  if (!to.starts_with(kOsc)) {
    throw InputError(fmt::format("--events {}: must be osc:HOST:PORT", to));
  }
  Endpoint endpoint;
  std::string why = find_endpoint(std::string(to.substr(kOsc.size())), endpoint);
  std::size_t longest = 0;
  for (const std::string& name : names_) longest = std::max(longest, name.size());
  const std::string text(longest, 'x');
  const std::array<std::string_view, 3> texts{text, text, text};
  bytes_.resize(osc_message_size(kEventAddress, texts, 2, OscNumber::kFloat32));
  if (why.empty()) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (socket_ < 0 || connect_socket(socket_, endpoint) != 0) {
      why = "there is no way to it from here";
    }
  }
  if (why.empty()) return;
  if (socket_ >= 0) ::close(socket_);
  throw InputError(fmt::format("--events {}: {}", to, why));
}

EventSender::~EventSender() { ::close(socket_); }

void EventSender::send(const EventRecord& event) noexcept {
  const std::array<std::string_view, 3> texts{
      kEventKinds[static_cast<std::size_t>(event.kind)],
      names_[static_cast<std::size_t>(event.object)],
      event.other < 0 ? std::string_view() : names_[static_cast<std::size_t>(event.other)]};
  const std::array<double, 2> numbers{event.time, event.impulse};
  OscWriter writer(bytes_);
  writer.message(kEventAddress, texts, numbers, OscNumber::kFloat32);
  // An error tells of an earlier datagram that nobody took; this one is sent by a second try.
  if (::send(socket_, bytes_.data(), writer.size(), MSG_NOSIGNAL) < 0) {
    (void)::send(socket_, bytes_.data(), writer.size(), MSG_NOSIGNAL);
  }
}

}  // namespace softfinger
