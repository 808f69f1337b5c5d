#pragma once

#include <filesystem>

namespace softfinger {

/// Nobody else writes a journal while it is held, as far as the file system can tell.
class JournalLock {
 public:
  /// `file` is made where it is absent. Throws InputError where another process holds it,
  /// OperationError where it cannot be made.
  JournalLock(const std::filesystem::path& file, const std::filesystem::path& journal);
  ~JournalLock();
  JournalLock(const JournalLock&) = delete;
  JournalLock& operator=(const JournalLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace softfinger
