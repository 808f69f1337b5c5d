#include "softfinger/loop/tick_handover.hpp"

#include <algorithm>

#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {
namespace {

/// A mailbox draft has to have its full size before the loop starts.
HandedTick largest(const FingerModel& model) {
  HandedTick handed;
  handed.contact = make_contact_set(model);
  handed.nodes_W.resize(model.mesh.nodes.size());
  return handed;
}

}  // namespace

TickHandover::TickHandover(const FingerModel& model) : mailbox_(largest(model)) {}

void TickHandover::hand_over(const TickInput& input, const VirtualFinger& finger) {
  last_ = input;
  HandedTick& draft = mailbox_.draft();
  draft.input = input;
  draft.contact = finger.contact;
  std::copy(finger.nodes_W.begin(), finger.nodes_W.end(), draft.nodes_W.begin());
  draft.X_WF = finger.X_WF;
  mailbox_.publish();
  ring();
}

const HandedTick* TickHandover::take() {
  while (true) {
    doorbell_.wait(heard_, std::memory_order_acquire);
    heard_ = doorbell_.load(std::memory_order_acquire);
    if (ended_.load()) return nullptr;
    if (mailbox_.refresh()) return &mailbox_.latest();
  }
}

void TickHandover::end() {
  ended_.store(true);
  ring();
}

void TickHandover::ring() {
  doorbell_.fetch_add(1, std::memory_order_release);
  doorbell_.notify_one();
}

}  // namespace softfinger
