#include "faulty_disk.hpp"

#include <atomic>
#include <cstddef>

namespace softfinger {
namespace {

sqlite3_vfs* real_disk = nullptr;
std::atomic<long> counted{0};
DiskFault fault_now = DiskFault::kFull;
long fails_at = 0;

struct File {
  sqlite3_file base;
  /// The real one lies behind it.
  [[nodiscard]] sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
sqlite3_file* real_of(sqlite3_file* file) { return reinterpret_cast<File*>(file)->real(); }

enum class Operation { kWrite, kSync, kDelete };
enum class Outcome { kDone, kDropped, kFails };

Outcome next(Operation operation) {
  const long number = counted++;
  switch (fault_now) {
    case DiskFault::kPowerCut:
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

int write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
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
  return real_of(file)->pMethods->xWrite(real_of(file), bytes, size, offset);
}

int truncate(sqlite3_file* file, sqlite3_int64 size) {
  const Outcome outcome = next(Operation::kDelete);
  if (outcome == Outcome::kDropped) return SQLITE_OK;
  if (outcome == Outcome::kFails) return SQLITE_IOERR_TRUNCATE;
  return real_of(file)->pMethods->xTruncate(real_of(file), size);
}

int sync(sqlite3_file* file, int flags) {
  const Outcome outcome = next(Operation::kSync);
  if (outcome == Outcome::kDropped) return SQLITE_OK;
  if (outcome == Outcome::kFails) return SQLITE_IOERR_FSYNC;
  return real_of(file)->pMethods->xSync(real_of(file), flags);
}

int delete_file(sqlite3_vfs*, const char* name, int sync_directory) {
  const Outcome outcome = next(Operation::kDelete);
  if (outcome == Outcome::kDropped) return SQLITE_OK;
  if (outcome == Outcome::kFails) return SQLITE_IOERR_DELETE;
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
  const int result = real_disk->xOpen(real_disk, name, real_of(file), flags, out_flags);
  if (real_of(file)->pMethods != nullptr) file->pMethods = &kMethods;
  return result;
}

}  // namespace

FaultyDisk::FaultyDisk(DiskFault fault, long at) {
  real_disk = sqlite3_vfs_find(nullptr);
  fault_now = fault;
  fails_at = at;
  counted = 0;
  disk_ = *real_disk;
  disk_.zName = "faulty";
  disk_.szOsFile = static_cast<int>(sizeof(File)) + real_disk->szOsFile;
  disk_.xOpen = open;
  disk_.xDelete = delete_file;
  sqlite3_vfs_register(&disk_, 1);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(&disk_);
  sqlite3_vfs_register(real_disk, 1);
}

long FaultyDisk::operations() const { return counted; }

}  // namespace softfinger
