#include "softfinger/actuation/line_channel.hpp"

#include <bit>

namespace softfinger {
namespace {

/// FNV-1a over values, since the bytes between them may be anything (Fowler, Noll, Vo; "The FNV
/// Non-Cryptographic Hash Algorithm").
class Seal {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ ((value >> (8 * byte)) & 0xFFU)) * 0x100000001B3U;
    }
  }
  void add(const Configuration& q) {
    add(static_cast<std::uint64_t>(q.size()));
    // A size that was spoilt leads nowhere.
    if (q.size() > kMaxDegreesOfFreedom) return;
    for (Eigen::Index i = 0; i < q.size(); ++i) add(std::bit_cast<std::uint64_t>(q[i]));
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

}  // namespace

std::uint64_t LineChannel::Wanted::seal_of_this() const noexcept {
  Seal all;
  all.add(q);
  all.add(static_cast<std::uint64_t>(state));
  all.add(std::bit_cast<std::uint64_t>(formed));
  all.add(number);
  return all.value();
}

std::uint64_t LineChannel::Sent::seal_of_this() const noexcept {
  Seal all;
  all.add(q);
  return all.value();
}

}  // namespace softfinger
