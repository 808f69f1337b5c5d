#include "softfinger/base/hash.hpp"

#define XXH_STATIC_LINKING_ONLY  // for the size of the state
#include <xxhash.h>

#include <cstring>

namespace softfinger {
namespace {

// The library's state lives in a byte array of ours, copied in and out: 88 bytes, so that its
// header stays here.
XXH64_state_t load(const void* bytes) {
  XXH64_state_t state;
  std::memcpy(&state, bytes, sizeof state);
  return state;
}

}  // namespace

Hash::Hash() : state_{} {
  static_assert(sizeof(XXH64_state_t) == sizeof state_);
  XXH64_state_t state;
  std::memset(&state, 0, sizeof state);
  XXH64_reset(&state, 0);
  std::memcpy(state_.data(), &state, sizeof state);
}

void Hash::take_in(std::span<const std::byte> bytes) {
  XXH64_state_t state = load(state_.data());
  XXH64_update(&state, waiting_.data(), waiting_count_);
  XXH64_update(&state, bytes.data(), bytes.size());
  waiting_count_ = 0;
  std::memcpy(state_.data(), &state, sizeof state);
}

std::uint64_t Hash::value() const {
  XXH64_state_t state = load(state_.data());
  XXH64_update(&state, waiting_.data(), waiting_count_);
  return XXH64_digest(&state);
}

}  // namespace softfinger
