#include "softfinger/study/journal_lock.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "softfinger/base/error.hpp"

namespace softfinger {

JournalLock::JournalLock(const std::filesystem::path& journal)
    : descriptor_(::open(file_of(journal).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw OperationError(fmt::format("{}: cannot be written: {}", file_of(journal).string(),
                                     std::generic_category().message(errno)));
  }
  // Where the file system has no locks none is held.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw InputError(
      fmt::format("{}: another run of this study writes it just now; wait for its "
                  "end, or give another --out",
                  journal.string()));
}

JournalLock::~JournalLock() { ::close(descriptor_); }

}  // namespace softfinger
