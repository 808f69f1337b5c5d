#include "softfinger/world/islands.hpp"

#include <algorithm>
#include <utility>

namespace softfinger {

Islands::Islands(std::size_t count) : parents_(count, kNone), island_of_(count, -1) {
  starts_.reserve(count + 1);
  members_.reserve(count);
}

void Islands::begin() { std::ranges::fill(parents_, kNone); }

std::size_t Islands::root(std::size_t n) {
  while (parents_[n] != n) {
    parents_[n] = parents_[parents_[n]];
    n = parents_[n];
  }
  return n;
}

void Islands::join(std::size_t a, std::size_t b) {
  if (!takes_part(a) || !takes_part(b)) return;
  a = root(a);
  b = root(b);
  if (a > b) std::swap(a, b);
  parents_[b] = a;
}

void Islands::find() {
  // Roots first, in order; then each counts as its island's.
  starts_.assign(1, 0);
  for (std::size_t n = 0; n < parents_.size(); ++n) {
    island_of_[n] = -1;
    if (!takes_part(n)) continue;
    const std::size_t first = root(n);
    if (first == n) {
      island_of_[n] = static_cast<int>(size());
      starts_.push_back(0);
    } else {
      island_of_[n] = island_of_[first];
    }
    ++starts_[static_cast<std::size_t>(island_of_[n]) + 1];
  }
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  members_.resize(starts_.back());
  for (std::size_t n = 0; n < parents_.size(); ++n) {
    if (island_of_[n] >= 0) members_[starts_[static_cast<std::size_t>(island_of_[n])]++] = n;
  }
  // Where each began.
  for (std::size_t i = starts_.size() - 1; i > 0; --i) starts_[i] = starts_[i - 1];
  starts_[0] = 0;
}

}  // namespace softfinger
