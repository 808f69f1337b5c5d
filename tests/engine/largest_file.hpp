#pragma once

#include <signal.h>
#include <sys/resource.h>

#include <cstddef>

namespace softfinger {

/// While it lives, no file of this process grows beyond so many bytes; whoever tries is refused, as
/// on a full disk.
class LargestFile {
 public:
  explicit LargestFile(std::size_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~LargestFile() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  LargestFile(const LargestFile&) = delete;
  LargestFile& operator=(const LargestFile&) = delete;

 private:
  rlimit before_{};
};

}  // namespace softfinger
