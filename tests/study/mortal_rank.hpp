#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/study/ranks.hpp"

namespace softfinger {

/// Stops, as a kill does, after so many tasks.
class MortalRank final : public Ranks {
 public:
  explicit MortalRank(std::size_t life) : life_(life) {}
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  std::string broadcast(const std::string& bytes) override { return bytes; }
  bool all(bool here) override { return here; }
  void share(std::size_t count, const Work& work, const Take& take,
             const std::atomic<bool>&) override {
    for (std::size_t task = 0; task < count; ++task) {
      if (life_-- == 0) throw OperationError("killed");
      take(task, work(task));
    }
  }

 private:
  std::size_t life_;
};

}  // namespace softfinger
