#include "softfinger/threads/awake_processors.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>

namespace softfinger {

AwakeProcessors::AwakeProcessors() noexcept
    : request_(::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)) {
  if (request_ < 0) return;
  constexpr std::int32_t kLongest = 0;  // us
  if (::write(request_, &kLongest, sizeof kLongest) != sizeof kLongest) {
    ::close(request_);
    request_ = -1;
  }
}

AwakeProcessors::~AwakeProcessors() {
  if (request_ >= 0) ::close(request_);
}

}  // namespace softfinger
