#pragma once

#include <sqlite3.h>

namespace softfinger {

/// What a disk does from some operation on.
enum class DiskFault {
  kFull,      ///< nothing more can be written, what was can be read
  kTorn,      ///< the same, and the write that met it is half there
  kNoSync,    ///< nothing can be made safe
  kBroken,    ///< this one operation fails, and no other
  kPowerCut,  ///< nothing more reaches the disk, and nobody is told
};

/// While it lives every SQLite database of this process is on a disk that fails at its `at`th
/// write, truncation, sync or deletion (from 0). One at a time.
class FaultyDisk {
 public:
  FaultyDisk(DiskFault fault, long at);
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// Operations that could have failed so far.
  [[nodiscard]] long operations() const;

 private:
  sqlite3_vfs disk_{};
};

}  // namespace softfinger
