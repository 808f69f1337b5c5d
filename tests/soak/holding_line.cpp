#include "holding_line.hpp"

#include <algorithm>

namespace softfinger {

void HoldingLine::receive(std::span<const std::uint8_t> bytes) {
  if (!holding_ && waiting_.empty()) return board_.receive(bytes);
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  most_waiting_ = std::max(most_waiting_.load(), waiting_.size());
}

void HoldingLine::advance_to(double time) {
  board_.advance_to(time);
  if (holding_) return;
  // One by one: who looks on sees each command.
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    board_.receive(std::span(waiting_).subspan(i, 1));
  }
  waiting_.clear();
}

}  // namespace softfinger
