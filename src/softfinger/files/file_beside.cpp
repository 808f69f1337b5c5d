#include "softfinger/files/file_beside.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace softfinger {
namespace {

constexpr int kMostNames = 10;  // a second one would be a wonder

}  // namespace

FileBeside::FileBeside(const std::filesystem::path& file, bool owner_alone) : file_(file) {
  for (int i = 0; i < kMostNames && descriptor_ < 0; ++i) {
    std::uint64_t random = 0;
    if (::getrandom(&random, sizeof random, 0) != sizeof random) return;
    name_ = fmt::format("{}.{:016x}", file.string(), random);
    descriptor_ = ::open(name_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                         owner_alone ? 0600 : 0666);
    if (descriptor_ < 0 && errno != EEXIST) return;
  }
}

FileBeside::~FileBeside() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!in_place_) ::unlink(name_.c_str());
}

bool FileBeside::write(const void* data, std::size_t size, std::uint64_t offset) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::pwrite(descriptor_, at, size, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    offset += static_cast<std::uint64_t>(written);
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool FileBeside::take_its_place() {
  in_place_ = std::rename(name_.c_str(), file_.c_str()) == 0;
  return in_place_;
}

}  // namespace softfinger
