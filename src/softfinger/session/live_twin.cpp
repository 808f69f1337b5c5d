#include "softfinger/session/live_twin.hpp"

#include <algorithm>

#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_priority.hpp"

namespace softfinger {

LiveTwin::LiveTwin(const std::shared_ptr<const FingerModel>& model,
                   const std::shared_ptr<const FingerModel>& wearer,
                   const std::shared_ptr<const Device>& device)
    : twin_(wearer, device),
      comparison_(model, wearer, SkinComparison::Depth::kSkin),
      shown_(counterparts_of_samples(*model, *wearer)),
      offers_(Offer{0.0, device->home(), make_contact_set(*model)}),
      presses_([this] {
        Snapshot::Twin unpressed;
        const std::size_t samples = shown_.size();
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
  show(contact, draft.skin);
  draft.sums() = contact.sums();
  comparison_.take_virtual(offer.contact, {});
  draft.measures = comparison_.compare(contact, {});
  draft.cpu_time = thread_cpu_time() - began;
  draft.pressed = true;
  presses_.publish();
}

void LiveTwin::show(const ContactSet& contact, Snapshot::Skin& skin) const {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    const SkinPlace& place = shown_[i];
    const auto& corners = twin_.wearer().skin_triangles[static_cast<std::size_t>(place.triangle)];
    Vector3 position_F = Vector3::Zero();
    double pressure = 0.0;
    double most = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const ContactSample& sample = contact.samples[static_cast<std::size_t>(corners[c])];
      const double weight = place.weights[c];
      position_F += weight * sample.position_F;
      pressure += weight * sample.pressure();
      if (weight <= most) continue;
      most = weight;
      skin.in_contact[i] = sample.touched() > 0.0 ? 1 : 0;
    }
    skin.positions_F[i] = position_F.cast<float>();
    skin.pressures[i] = static_cast<float>(pressure);
  }
}

}  // namespace softfinger
