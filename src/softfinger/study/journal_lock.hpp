#pragma once

#include <filesystem>

namespace softfinger {

/// Nobody else writes a journal while it is held, as far as the file system can tell.
class JournalLock {
 public:
  /// Throws InputError where another process holds it, OperationError where file_of() it cannot be
  /// made.
  explicit JournalLock(const std::filesystem::path& journal);
  ~JournalLock();
  JournalLock(const JournalLock&) = delete;
  JournalLock& operator=(const JournalLock&) = delete;

  /// The file beside a journal that is locked.
  [[nodiscard]] static std::filesystem::path file_of(std::filesystem::path journal) {
    return journal.replace_extension(".lock");
  }

 private:
  int descriptor_;
};

}  // namespace softfinger
