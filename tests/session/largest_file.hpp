#pragma once

#include <signal.h>
#include <sys/resource.h>

#include <cstddef>
#include <stdexcept>

namespace softfinger {

/// While it lives, no file of this process grows beyond so many bytes; whoever tries is refused, as
/// on a full disk.
class LargestFile {
 public:
  explicit LargestFile(std::size_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) throw std::runtime_error("no limit of file sizes");
  }
  ~LargestFile() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  LargestFile(const LargestFile&) = delete;
  LargestFile& operator=(const LargestFile&) = delete;

 private:
  rlimit before_{};
};

}  // namespace softfinger
