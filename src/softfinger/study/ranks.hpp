#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace softfinger {

/// The processes that share out the work of a study: ranks 0 to size - 1, alike but for the first,
/// which alone writes. All functions but rank() and size() are called by every rank, in the same
/// order, and throw nothing of their own.
class Ranks {
 public:
  /// Does a task, on any rank.
  using Work = std::function<std::string(std::size_t task)>;
  /// Has its result, on rank 0; one after the other, on any thread.
  using Take = std::function<void(std::size_t task, std::string_view result)>;

  virtual ~Ranks() = default;
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;
  /// What rank 0 gives, to all.
  virtual std::string broadcast(const std::string& bytes) = 0;
  /// Whether it is so on every rank.
  virtual bool all(bool here) = 0;
  /// Each of `count` tasks is done once by whoever is free next, in their order; a rank goes on to
  /// another when its result was taken, so that a kill loses at most one of each. Ends where all
  /// are taken, or `stop` became true on some rank, or `work` or `take` threw, which is thrown
  /// again on that rank when the others have ended.
  virtual void share(std::size_t count, const Work& work, const Take& take,
                     const std::atomic<bool>& stop) = 0;
};

/// This process alone.
class OneRank final : public Ranks {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  std::string broadcast(const std::string& bytes) override { return bytes; }
  bool all(bool here) override { return here; }
  void share(std::size_t count, const Work& work, const Take& take,
             const std::atomic<bool>& stop) override;
};

/// All processes of the parallel job that this one is part of (mpirun, srun), else this one alone.
/// Throws OperationError where this program's part for them is missing.
[[nodiscard]] std::unique_ptr<Ranks> ranks_of_this_job();

}  // namespace softfinger
