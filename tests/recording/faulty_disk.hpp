#pragma once

#include <sqlite3.h>

#include <chrono>

namespace softfinger {

/// What a disk does from some operation on.
enum class DiskFault {
  kFull,      ///< nothing more can be written, what was can be read
  kTorn,      ///< the same, and the write that met it is half there
  kNoSync,    ///< nothing can be made safe
  kBroken,    ///< this one operation fails, and no other
  kPowerCut,  ///< nothing more reaches the disk, and nobody is told
  kUnsynced,  ///< the same, and of what was written since the last sync any part is lost, once the
              ///< FaultyDisk ends; truncations and deletions are not overtaken by what came later
};

/// How much longer than a real disk's operations take.
struct DiskDelays {
  std::chrono::microseconds sync{0};
  std::chrono::microseconds write{0};
};

/// What a disk that hangs does not come back from.
enum class Held { kNothing, kSyncs, kWritesToFiles /**< to a database itself, not to its logs */ };

/// While it lives every SQLite database of this process is on a disk that fails at its `at`th
/// write, truncation, sync or deletion (from 0), or is slow. One at a time.
class FaultyDisk {
 public:
  FaultyDisk(DiskFault fault, long at, DiskDelays delays = {});
  explicit FaultyDisk(DiskDelays delays);  ///< fails never
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// Operations that could have failed so far.
  [[nodiscard]] long operations() const;
  /// Logs that were truncated before it failed.
  [[nodiscard]] long truncated_logs() const;

  /// What begins between these two ends after the second, or when the disk does.
  void hold(Held held);
  void release();
  /// From now on it takes no longer than a real one.
  void end_delays();

  [[nodiscard]] long syncs_begun() const;
  [[nodiscard]] long syncs_ended() const;

  /// From now on the next two count, from 0.
  void watch();
  /// Writes to a database itself that began.
  [[nodiscard]] long writes_to_files() const;
  /// Syncs by threads that have written to a log.
  [[nodiscard]] long syncs_by_who_writes_logs() const;

 private:
  sqlite3_vfs disk_{};
};

}  // namespace softfinger
