#include "softfinger/actuation/line_channel.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

namespace softfinger {
namespace {

/// FNV-1a of the bytes of values, least first.
class ReferenceHash {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte, value >>= 8) {
      hash_ ^= value & 0xFF;
      hash_ *= 1099511628211U;
    }
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Configuration& q) {
    add(static_cast<std::uint64_t>(q.size()));
    for (const double one : q) add(one);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037U;
};

// Two builds of one version have to agree about it, and every member counts.
TEST(LineChannel, SealsAreFnvHashesOfAllThereIs) {
  for (const int size : {0, 1, 3, kMaxDegreesOfFreedom}) {
    LineChannel::Wanted wanted{.q = Configuration::LinSpaced(size, -1.0, 2.0),
                               .state = DeviceState::kRendering,
                               .formed = 12.75,
                               .number = 0x0123456789ABCDEFU};
    ReferenceHash of_wanted;
    of_wanted.add(wanted.q);
    of_wanted.add(static_cast<std::uint64_t>(wanted.state));
    of_wanted.add(wanted.formed);
    of_wanted.add(wanted.number);
    EXPECT_EQ(wanted.seal_of_this(), of_wanted.value()) << size;
    EXPECT_FALSE(wanted.is_whole());
    wanted.seal = of_wanted.value();
    EXPECT_TRUE(wanted.is_whole());

    LineChannel::Sent sent{.q = wanted.q};
    ReferenceHash of_sent;
    of_sent.add(sent.q);
    EXPECT_EQ(sent.seal_of_this(), of_sent.value()) << size;
    EXPECT_FALSE(sent.is_whole());
    sent.seal = of_sent.value();
    EXPECT_TRUE(sent.is_whole());
  }
}

}  // namespace
}  // namespace softfinger
