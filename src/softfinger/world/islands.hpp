#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace softfinger {

/// Which of some numbered things hang together, directly or by way of others: islands, in the order
/// of their least numbers, each with its members in order. Allocates nothing after its making.
///
///     islands.begin(); islands.take(n) ...; islands.join(a, b) ...; islands.find();
class Islands {
 public:
  explicit Islands(std::size_t count = 0);

  /// None takes part.
  void begin();
  void take(std::size_t n) { parents_[n] = n; }
  [[nodiscard]] bool takes_part(std::size_t n) const { return parents_[n] != kNone; }
  /// Both take part and hang together; nothing where one does not.
  void join(std::size_t a, std::size_t b);
  void find();

  [[nodiscard]] std::size_t size() const { return starts_.size() - 1; }
  [[nodiscard]] std::span<const std::size_t> members(std::size_t island) const {
    return {members_.data() + starts_[island], starts_[island + 1] - starts_[island]};
  }
  /// -1: it takes no part.
  [[nodiscard]] int island_of(std::size_t n) const { return island_of_[n]; }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t root(std::size_t n);

  std::vector<std::size_t> parents_;  ///< the root of each island is its least number
  std::vector<int> island_of_;
  std::vector<std::size_t> starts_{0}, members_;
};

}  // namespace softfinger
