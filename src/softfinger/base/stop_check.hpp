#pragma once

#include <stop_token>

#include "softfinger/base/error.hpp"

namespace softfinger {

/// Lets work that may take seconds end from within where nobody wants it any more. One thread.
class StopCheck {
 public:
  explicit StopCheck(const std::stop_token& stop) : stop_(stop) {}

  /// Throws InputError once `stop` asks for an end.
  static void now(const std::stop_token& stop) {
    if (stop.stop_requested()) throw InputError("is no longer wanted");
  }
  /// The same, in one of many calls: cheap enough for where there are millions of them.
  void operator()() {
    if (++calls_ % kCallsALook == 0) now(stop_);
  }

 private:
  static constexpr unsigned kCallsALook = 4096;

  const std::stop_token& stop_;
  unsigned calls_ = 0;
};

}  // namespace softfinger
