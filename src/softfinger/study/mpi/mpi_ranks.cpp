// The module that is loaded under mpirun: Ranks by MPI. Nothing else of the program includes MPI.
#define OMPI_SKIP_MPICXX 1  // NOLINT: asked for by its name
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/study/ranks.hpp"

namespace softfinger {
namespace {

constexpr int kResult = 1;   // tag: number of a task, then its result
constexpr int kTaken = 2;    // tag: it was taken
constexpr int kThrough = 3;  // tag: a rank begins no further task
/// MPI waits by asking again and again, which takes a processor from whoever computes.
constexpr auto kLookAgain = std::chrono::microseconds(200);

template <typename IsDone>
void wait_until(const IsDone& is_done) {
  while (!is_done()) std::this_thread::sleep_for(kLookAgain);
}

void wait_for(MPI_Request& request) {
  wait_until([&] {
    int done = 0;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
}

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    const MPI_Aint bytes = rank_ == 0 ? sizeof(std::int64_t) : 0;
    MPI_Win_allocate(bytes, sizeof(std::int64_t), MPI_INFO_NULL, MPI_COMM_WORLD, &counter_,
                     &window_);
    MPI_Win_lock_all(0, window_);
  }
  ~MpiRanks() override {
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
    MPI_Finalize();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  std::string broadcast(const std::string& bytes) override {
    std::int64_t length = static_cast<std::int64_t>(bytes.size());
    broadcast_bytes(&length, sizeof length);
    std::string result = bytes;
    result.resize(static_cast<std::size_t>(length));
    for (std::size_t at = 0; at < result.size(); at += kMostAtOnce) {
      broadcast_bytes(result.data() + at, std::min(kMostAtOnce, result.size() - at));
    }
    return result;
  }

  bool all(bool here) override {
    const int mine = here ? 1 : 0;
    int every = 0;
    MPI_Request request{};
    MPI_Iallreduce(&mine, &every, 1, MPI_INT, MPI_LAND, MPI_COMM_WORLD, &request);
    wait_for(request);
    return every != 0;
  }

  void share(std::size_t count, const Work& work, const Take& take,
             const std::atomic<bool>& stop) override {
    if (rank_ == 0) exchange(0);
    barrier();
    end_ = static_cast<std::int64_t>(count);
    std::exception_ptr thrown;
    std::mutex mutex;  // of `take`
    const auto take_one = [&](std::size_t task, std::string_view result) {
      const std::lock_guard lock(mutex);
      if (thrown) return;
      try {
        take(task, result);
      } catch (...) {
        thrown = std::current_exception();
        end_all();
      }
    };
    std::thread receiver;
    if (rank_ == 0) receiver = std::thread([&] { receive(take_one); });
    try {
      while (!stop.load()) {
        const std::int64_t task = next();
        if (task >= end_) break;
        const std::string result = work(static_cast<std::size_t>(task));
        if (rank_ == 0) {
          take_one(static_cast<std::size_t>(task), result);
        } else {
          send(task, result);
        }
      }
      if (stop.load()) end_all();
    } catch (...) {
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
      end_all();
    }
    if (rank_ == 0) {
      receiver.join();
    } else {
      MPI_Send(nullptr, 0, MPI_BYTE, 0, kThrough, MPI_COMM_WORLD);
    }
    barrier();
    if (thrown) std::rethrow_exception(thrown);
  }

 private:
  static constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

  void broadcast_bytes(void* data, std::size_t size) {
    MPI_Request request{};
    MPI_Ibcast(data, static_cast<int>(size), MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    wait_for(request);
  }
  void barrier() {
    MPI_Request request{};
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    wait_for(request);
  }
  /// The one counter of all ranks.
  std::int64_t next() { return fetch(1, MPI_SUM); }
  void exchange(std::int64_t value) { static_cast<void>(fetch(value, MPI_REPLACE)); }
  void end_all() { exchange(end_); }
  std::int64_t fetch(std::int64_t value, MPI_Op how) {
    std::int64_t result = 0;
    MPI_Fetch_and_op(&value, &result, MPI_INT64_T, 0, 0, how, window_);
    MPI_Win_flush(0, window_);
    return result;
  }

  void send(std::int64_t task, const std::string& result) {
    std::string message(sizeof task + result.size(), '\0');
    std::memcpy(message.data(), &task, sizeof task);
    std::memcpy(message.data() + sizeof task, result.data(), result.size());
    MPI_Send(message.data(), static_cast<int>(message.size()), MPI_BYTE, 0, kResult,
             MPI_COMM_WORLD);
    MPI_Request request{};
    MPI_Irecv(nullptr, 0, MPI_BYTE, 0, kTaken, MPI_COMM_WORLD, &request);
    wait_for(request);
  }

  /// Rank 0, beside its own work, until every other rank is through.
  template <typename TakeOne>
  void receive(const TakeOne& take_one) {
    for (int through = 0; through < size_ - 1;) {
      MPI_Status status{};
      wait_until([&] {
        int there = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
        return there != 0;
      });
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      std::string message(static_cast<std::size_t>(size), '\0');
      MPI_Recv(message.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
               MPI_STATUS_IGNORE);
      if (status.MPI_TAG == kThrough) {
        ++through;
        continue;
      }
      std::int64_t task = 0;
      std::memcpy(&task, message.data(), sizeof task);
      take_one(static_cast<std::size_t>(task), std::string_view(message).substr(sizeof task));
      MPI_Send(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, kTaken, MPI_COMM_WORLD);
    }
  }

  int rank_ = 0, size_ = 1;
  MPI_Win window_ = MPI_WIN_NULL;
  std::int64_t* counter_ = nullptr;
  std::int64_t end_ = 0;
};

}  // namespace
}  // namespace softfinger

/// Null where threads may not call MPI side by side.
extern "C" softfinger::Ranks* softfinger_make_mpi_ranks();

extern "C" softfinger::Ranks* softfinger_make_mpi_ranks() {
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &provided);
  if (provided < MPI_THREAD_MULTIPLE) {
    MPI_Finalize();
    return nullptr;
  }
  return new softfinger::MpiRanks();
}
