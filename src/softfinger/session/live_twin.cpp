#include "softfinger/session/live_twin.hpp"

#include <algorithm>

#include "softfinger/session/scene_snapshot.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_priority.hpp"

namespace softfinger {

LiveTwin::LiveTwin(const std::shared_ptr<const FingerModel>& model,
                   const std::shared_ptr<const Device>& device)
    : twin_(model, device), offers_(Offer{0.0, device->home(), twin_.contact()}), presses_([this] {
        Snapshot::Twin unpressed;
        const std::size_t samples = twin_.contact().samples.size();
        unpressed.skin.positions_F.resize(samples, Eigen::Vector3f::Zero());
        unpressed.skin.pressures.resize(samples);
        unpressed.skin.in_contact.resize(samples);
        return unpressed;
      }()) {}

LiveTwin::~LiveTwin() { end(); }

void LiveTwin::start() {
  thread_ = std::thread([this] { serve(); });
}

void LiveTwin::end() {
  ending_.store(true);
  doorbell_.fetch_add(1, std::memory_order_release);
  doorbell_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void LiveTwin::offer(const TickRecord& tick, const ContactSet& contact) {
  Offer& draft = offers_.draft();
  draft.time = tick.time;
  draft.configuration = tick.command.configuration;
  draft.contact = contact;
  offers_.publish();
  doorbell_.fetch_add(1, std::memory_order_release);
  doorbell_.notify_one();
}

void LiveTwin::serve() {
  defer_this_thread();
  std::uint32_t heard = 0;
  while (true) {
    doorbell_.wait(heard, std::memory_order_acquire);
    heard = doorbell_.load(std::memory_order_acquire);
    if (ending_.load()) return;
    if (offers_.refresh()) press(offers_.latest());
  }
}

void LiveTwin::press(const Offer& offer) {
  const double began = thread_cpu_time();
  twin_.press(offer.configuration, offer.contact.friction_coefficient,
              std::max(0.0, offer.time - time_));
  time_ = offer.time;
  const ContactSet& contact = twin_.contact();
  Snapshot::Twin& draft = presses_.draft();
  fill(draft.skin, contact);
  draft.sums() = contact.sums();
  draft.measures = compare({offer.contact, {}, {}, {}}, {contact, {}, {}, {}});
  draft.cpu_time = thread_cpu_time() - began;
  draft.pressed = true;
  presses_.publish();
}

}  // namespace softfinger
