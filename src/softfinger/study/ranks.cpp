#include "softfinger/study/ranks.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>

#include "softfinger/base/error.hpp"
#include "softfinger/study/loaded_module.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "softfinger-mpi.so";

/// Empty: not set.
std::string_view environment(const char* variable) {
  const char* text = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe)
  return text == nullptr ? std::string_view() : text;
}

/// Started by Open MPI's mpirun, or as one of several tasks by Slurm's srun.
bool in_parallel_job() {
  const std::string_view tasks = environment("SLURM_STEP_NUM_TASKS");
  return !environment("OMPI_COMM_WORLD_SIZE").empty() || (!tasks.empty() && tasks != "1");
}

}  // namespace

void OneRank::share(std::size_t count, const Work& work, const Take& take,
                    const std::atomic<bool>& stop) {
  for (std::size_t task = 0; task < count && !stop.load(); ++task) take(task, work(task));
}

std::unique_ptr<Ranks> ranks_of_this_job() {
  if (!in_parallel_job()) return std::make_unique<OneRank>();
  const fs::path file = module_file(kModule);
  if (file.empty()) {
    throw OperationError(
        fmt::format("mpirun: this program has no {} beside it or in "
                    "lib/softfinger; build it where libopenmpi-dev is installed, "
                    "or use --shard",
                    kModule));
  }
  // Loaded only here: who runs no parallel job needs no MPI, and no time to start it.
  void* make = module_function(file, "softfinger_make_mpi_ranks");
  if (make == nullptr) {
    throw OperationError(
        fmt::format("{}: cannot be loaded; are Open MPI's libraries here?", file.string()));
  }
  Ranks* ranks = reinterpret_cast<Ranks* (*)()>(make)();
  if (ranks == nullptr) {
    throw OperationError(
        "mpirun: this MPI does not let more than one thread call it "
        "(MPI_THREAD_MULTIPLE); use another, or --shard");
  }
  return std::unique_ptr<Ranks>(ranks);
}

}  // namespace softfinger
