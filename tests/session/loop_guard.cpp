#include "loop_guard.hpp"

#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>

namespace {

constinit thread_local bool guarded = false;
constinit thread_local bool telling = false;
constinit std::atomic<std::uint64_t> allocations{0};
constinit std::atomic<std::uint64_t> locks{0};
constinit std::atomic<std::uint64_t> threads{0};

void tell_where(std::uint64_t earlier) {
  if (earlier > 0 || telling) return;
  telling = true;
  void* frames[32];
  backtrace_symbols_fd(frames, backtrace(frames, 32), STDERR_FILENO);
  telling = false;
}

[[maybe_unused]] void count(std::atomic<std::uint64_t>& counter) {
  if (guarded && !telling) tell_where(counter.fetch_add(1));
}

}  // namespace

#ifndef SOFTFINGER_SANITIZED

extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* pointer, std::size_t size);           // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) {
  count(allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count(allocations);
  return __libc_calloc(number, size);
}
void* realloc(void* pointer, std::size_t size) {
  count(allocations);
  return __libc_realloc(pointer, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count(allocations);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) {
  count(allocations);
  *pointer = __libc_memalign(alignment, size);
  return *pointer == nullptr ? ENOMEM : 0;
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const Lock next = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  count(locks);
  return next(mutex);
}
}

namespace softfinger {
bool guard_works() { return true; }
}  // namespace softfinger

#else

namespace softfinger {
bool guard_works() { return false; }
}  // namespace softfinger

#endif

namespace softfinger {

void guard_this_thread() {
  void* frame[1];
  backtrace(frame, 1);  // loads what it needs while that may allocate
  threads.fetch_add(1);
  guarded = true;
}

GuardCounts guard_counts() { return {allocations.load(), locks.load(), threads.load()}; }

void reset_guard() {
  allocations = 0;
  locks = 0;
  threads = 0;
}

}  // namespace softfinger
