#include "faulty_disk.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace softfinger {
namespace {

/// What a file would hold if the power went now.
struct DurableFile {
  struct Change {
    std::size_t at;                    ///< where it is written, or ends
    std::optional<std::string> bytes;  ///< none: a truncation
  };
  std::string synced;
  std::vector<Change> unsynced;

  static void apply(const Change& change, std::string& content) {
    if (!change.bytes) {
      content.resize(change.at);
      return;
    }
    if (content.size() < change.at + change.bytes->size()) {
      content.resize(change.at + change.bytes->size());
    }
    content.replace(change.at, change.bytes->size(), *change.bytes);
  }

  void sync() {
    for (const Change& change : unsynced) apply(change, synced);
    unsynced.clear();
  }

  /// Some of what is not synced reached the disk all the same.
  void lose_power(std::mt19937& random) {
    for (const Change& change : unsynced) {
      const bool reached = random() % 2 == 0;
      if (!reached && !change.bytes) return;
      if (reached) apply(change, synced);
    }
  }
};

sqlite3_vfs* real_disk = nullptr;
std::atomic<long> counted{0};
DiskFault fault_now = DiskFault::kFull;
long fails_at = 0;
std::atomic<std::chrono::microseconds> sync_delay, write_delay;

std::mutex disk_mutex;  // of all that follow
std::condition_variable released;
Held held_now = Held::kNothing;
std::set<std::thread::id> writers_of_logs;
std::map<std::string, DurableFile> durable_files;

std::atomic<long> syncs_that_began{0};
std::atomic<long> syncs_that_ended{0};
std::atomic<long> file_writes{0};
std::atomic<long> syncs_by_writers{0};
std::atomic<long> log_truncations{0};

struct File {
  sqlite3_file base;
  const char* name;
  bool is_database;  ///< not one of its logs
  /// The real one lies behind it.
  [[nodiscard]] sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File& file_of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
sqlite3_file* real_of(sqlite3_file* file) { return file_of(file).real(); }

enum class Operation { kWrite, kSync, kDelete };
enum class Outcome { kDone, kDropped, kFails };

Outcome next(Operation operation) {
  const long number = counted++;
  switch (fault_now) {
    case DiskFault::kPowerCut:
    case DiskFault::kUnsynced:
      return number >= fails_at ? Outcome::kDropped : Outcome::kDone;
    case DiskFault::kBroken:
      return number == fails_at ? Outcome::kFails : Outcome::kDone;
    case DiskFault::kNoSync:
      return number >= fails_at && operation == Operation::kSync ? Outcome::kFails : Outcome::kDone;
    case DiskFault::kFull:
    case DiskFault::kTorn:
      break;
  }
  return number >= fails_at && operation == Operation::kWrite ? Outcome::kFails : Outcome::kDone;
}

void remember(sqlite3_file* file, std::size_t at, std::optional<std::string> bytes) {
  if (fault_now != DiskFault::kUnsynced || file_of(file).name == nullptr) return;
  const std::lock_guard lock(disk_mutex);
  durable_files[file_of(file).name].unsynced.push_back({at, std::move(bytes)});
}

void wait_while(Held held) {
  std::unique_lock lock(disk_mutex);
  released.wait(lock, [&] { return held_now != held; });
}

/// As long as a slow disk's takes.
void wait_for_write(sqlite3_file* file) {
  if (file_of(file).is_database) {
    ++file_writes;
    wait_while(Held::kWritesToFiles);
  } else {
    const std::lock_guard lock(disk_mutex);
    writers_of_logs.insert(std::this_thread::get_id());
  }
  std::this_thread::sleep_for(write_delay.load());
}

void wait_for_sync() {
  ++syncs_that_began;
  {
    const std::lock_guard lock(disk_mutex);
    if (writers_of_logs.contains(std::this_thread::get_id())) ++syncs_by_writers;
  }
  std::this_thread::sleep_for(sync_delay.load());
  wait_while(Held::kSyncs);
}

int write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  wait_for_write(file);
  switch (next(Operation::kWrite)) {
    case Outcome::kDropped:
      return SQLITE_OK;
    case Outcome::kFails:
      if (fault_now == DiskFault::kTorn && counted == fails_at + 1) {
        real_of(file)->pMethods->xWrite(real_of(file), bytes, size / 2, offset);
      }
      return fault_now == DiskFault::kBroken ? SQLITE_IOERR_WRITE : SQLITE_FULL;
    case Outcome::kDone:
      break;
  }
  remember(file, static_cast<std::size_t>(offset),
           std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size)));
  return real_of(file)->pMethods->xWrite(real_of(file), bytes, size, offset);
}

int truncate(sqlite3_file* file, sqlite3_int64 size) {
  const Outcome outcome = next(Operation::kDelete);
  if (outcome == Outcome::kDropped) return SQLITE_OK;
  if (outcome == Outcome::kFails) return SQLITE_IOERR_TRUNCATE;
  if (!file_of(file).is_database) ++log_truncations;
  remember(file, static_cast<std::size_t>(size), std::nullopt);
  return real_of(file)->pMethods->xTruncate(real_of(file), size);
}

int sync(sqlite3_file* file, int flags) {
  const Outcome outcome = next(Operation::kSync);
  if (outcome == Outcome::kDone && fault_now == DiskFault::kUnsynced &&
      file_of(file).name != nullptr) {
    const std::lock_guard lock(disk_mutex);
    durable_files[file_of(file).name].sync();
  }
  wait_for_sync();
  const int result = outcome == Outcome::kDropped ? SQLITE_OK
                     : outcome == Outcome::kFails
                         ? SQLITE_IOERR_FSYNC
                         : real_of(file)->pMethods->xSync(real_of(file), flags);
  ++syncs_that_ended;
  return result;
}

int delete_file(sqlite3_vfs*, const char* name, int sync_directory) {
  const Outcome outcome = next(Operation::kDelete);
  if (outcome == Outcome::kDropped) return SQLITE_OK;
  if (outcome == Outcome::kFails) return SQLITE_IOERR_DELETE;
  {
    const std::lock_guard lock(disk_mutex);
    durable_files.erase(name);
  }
  return real_disk->xDelete(real_disk, name, sync_directory);
}

/// The rest is the real disk's.
const sqlite3_io_methods kMethods{
    .iVersion = 2,
    .xClose = [](sqlite3_file* f) { return real_of(f)->pMethods->xClose(real_of(f)); },
    .xRead =
        [](sqlite3_file* f, void* bytes, int size, sqlite3_int64 at) {
          return real_of(f)->pMethods->xRead(real_of(f), bytes, size, at);
        },
    .xWrite = write,
    .xTruncate = truncate,
    .xSync = sync,
    .xFileSize =
        [](sqlite3_file* f, sqlite3_int64* size) {
          return real_of(f)->pMethods->xFileSize(real_of(f), size);
        },
    .xLock = [](sqlite3_file* f,
                int lock) { return real_of(f)->pMethods->xLock(real_of(f), lock); },
    .xUnlock = [](sqlite3_file* f,
                  int lock) { return real_of(f)->pMethods->xUnlock(real_of(f), lock); },
    .xCheckReservedLock =
        [](sqlite3_file* f, int* out) {
          return real_of(f)->pMethods->xCheckReservedLock(real_of(f), out);
        },
    // Also what size a file may be given beforehand, which is no write.
    .xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; },
    .xSectorSize = [](sqlite3_file* f) { return real_of(f)->pMethods->xSectorSize(real_of(f)); },
    .xDeviceCharacteristics =
        [](sqlite3_file* f) { return real_of(f)->pMethods->xDeviceCharacteristics(real_of(f)); },
    .xShmMap =
        [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
          return real_of(f)->pMethods->xShmMap(real_of(f), page, size, extend, out);
        },
    .xShmLock =
        [](sqlite3_file* f, int offset, int n, int flags) {
          return real_of(f)->pMethods->xShmLock(real_of(f), offset, n, flags);
        },
    .xShmBarrier = [](sqlite3_file* f) { real_of(f)->pMethods->xShmBarrier(real_of(f)); },
    .xShmUnmap = [](sqlite3_file* f,
                    int remove) { return real_of(f)->pMethods->xShmUnmap(real_of(f), remove); },
    .xFetch = nullptr,
    .xUnfetch = nullptr,
};

int open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  file->pMethods = nullptr;
  file_of(file).name = name;  // SQLite keeps it until it closes the file
  file_of(file).is_database = (flags & SQLITE_OPEN_MAIN_DB) != 0;
  const int result = real_disk->xOpen(real_disk, name, real_of(file), flags, out_flags);
  if (real_of(file)->pMethods != nullptr) file->pMethods = &kMethods;
  return result;
}

void lose_unsynced() {
  std::mt19937 random(static_cast<unsigned>(fails_at));
  for (auto& [name, file] : durable_files) {
    file.lose_power(random);
    if (!std::filesystem::exists(name)) continue;
    std::ofstream(name, std::ios::binary | std::ios::trunc) << file.synced;
  }
}

}  // namespace

FaultyDisk::FaultyDisk(DiskFault fault, long at, DiskDelays delays) {
  real_disk = sqlite3_vfs_find(nullptr);
  fault_now = fault;
  fails_at = at;
  sync_delay = delays.sync;
  write_delay = delays.write;
  counted = 0;
  log_truncations = 0;
  syncs_that_began = 0;
  syncs_that_ended = 0;
  durable_files.clear();
  watch();
  disk_ = *real_disk;
  disk_.zName = "faulty";
  disk_.szOsFile = static_cast<int>(sizeof(File)) + real_disk->szOsFile;
  disk_.xOpen = open;
  disk_.xDelete = delete_file;
  sqlite3_vfs_register(&disk_, 1);
}

FaultyDisk::FaultyDisk(DiskDelays delays)
    : FaultyDisk(DiskFault::kFull, std::numeric_limits<long>::max(), delays) {}

FaultyDisk::~FaultyDisk() {
  release();
  sqlite3_vfs_unregister(&disk_);
  sqlite3_vfs_register(real_disk, 1);
  if (fault_now == DiskFault::kUnsynced) lose_unsynced();
}

long FaultyDisk::operations() const { return counted; }
long FaultyDisk::truncated_logs() const { return log_truncations; }

void FaultyDisk::hold(Held held) {
  {
    const std::lock_guard lock(disk_mutex);
    held_now = held;
  }
  released.notify_all();
}

void FaultyDisk::release() { hold(Held::kNothing); }

void FaultyDisk::end_delays() {
  sync_delay = std::chrono::microseconds(0);
  write_delay = std::chrono::microseconds(0);
}

long FaultyDisk::syncs_begun() const { return syncs_that_began; }
long FaultyDisk::syncs_ended() const { return syncs_that_ended; }

void FaultyDisk::watch() {
  const std::lock_guard lock(disk_mutex);
  writers_of_logs.clear();
  syncs_by_writers = 0;
  file_writes = 0;
}

long FaultyDisk::writes_to_files() const { return file_writes; }
long FaultyDisk::syncs_by_who_writes_logs() const { return syncs_by_writers; }

}  // namespace softfinger
