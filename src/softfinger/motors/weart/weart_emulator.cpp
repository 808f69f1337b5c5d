#include "softfinger/motors/weart/weart_emulator.hpp"

#include <algorithm>
#include <string_view>

namespace softfinger {

WeartEmulator::WeartEmulator(const TransportSettings& transport, const EmulatedServo& point)
    : address_(transport.servos.front().address), motion_(point) {}

void WeartEmulator::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (const auto request = reader_.push(byte)) execute(*request);
  }
  refused_ = wrong_ + reader_.malformed();
}

void WeartEmulator::execute(const WeartRequest& request) {
  switch (request.kind) {
    case WeartRequest::Kind::kStart: {
      started_ = true;
      constexpr std::string_view kGreeting = "{\"type\":\"MW_STATUS\",\"ts\":0,\"data\":{}}~";
      replies_.add({reinterpret_cast<const std::uint8_t*>(kGreeting.data()), kGreeting.size()});
      break;
    }
    case WeartRequest::Kind::kStop:
      started_ = false;
      wanted_ = 0.0;
      break;
    case WeartRequest::Kind::kForce:
    case WeartRequest::Kind::kStopForce:
      if (!started_ || request.address != address_) {
        ++wrong_;
        break;
      }
      wanted_ = request.force;
      ++commands_;
      if (request.kind == WeartRequest::Kind::kStopForce) ++stops_;
      largest_ = std::max(largest_.load(), wanted_);
      break;
    case WeartRequest::Kind::kOther:
      ++wrong_;
      break;
  }
}

void WeartEmulator::advance_to(double time) {
  for (int step = clock_.steps_to(time); step > 0; --step) {
    motion_.move(wanted_ / motion_.servo().step);
  }
}

}  // namespace softfinger
