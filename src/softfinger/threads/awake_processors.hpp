#pragma once

namespace softfinger {

/// While one lives, no processor of this machine falls asleep where it would take time to wake up:
/// Linux's request for least latency, as cyclictest makes it, where the system grants it
/// (/dev/cpu_dma_latency is writable); it costs power. Most of all it helps in virtual machines,
/// whose sleeping processors are given to others.
class AwakeProcessors {
 public:
  AwakeProcessors() noexcept;
  ~AwakeProcessors();
  AwakeProcessors(const AwakeProcessors&) = delete;
  AwakeProcessors& operator=(const AwakeProcessors&) = delete;

  [[nodiscard]] bool granted() const noexcept { return request_ >= 0; }

 private:
  int request_ = -1;  ///< held as long as it is open
};

}  // namespace softfinger
