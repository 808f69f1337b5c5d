#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "softfinger/softfinger.h"

namespace softfinger {

/// What a handle of the C interface points to. The handle itself is never given back, some tens of
/// bytes, so that a call on one that has ended finds out; what it holds ends with destroy(), or as
/// soon as the last call inside is left. Any thread.
template <typename Held>
class Handle {
 public:
  explicit Handle(std::unique_ptr<Held> held) : held_(held.release()) { keep(this); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  void destroy() noexcept {
    if (uses_.fetch_or(kEnded) == 0) give_back();
  }

  /// Being inside a call: as one that needs the handle for itself, or as one that does not mind
  /// others. Converts to false, and wrong() says why, where that cannot be.
  class Use {
   public:
    enum Kind { kAlone, kAnyThread };
    Use(const Handle* handle, Kind kind) noexcept : handle_(handle), kind_(kind) {
      if (handle_ == nullptr) {
        wrong_ = "the handle is NULL";
      } else if ((handle_->uses_.fetch_add(1) & kEnded) != 0) {
        wrong_ = kHasEnded;
      } else if (kind_ == kAlone && handle_->alone_.exchange(true)) {
        wrong_ = "another thread is inside a call on this handle; one thread at a time";
        kind_ = kAnyThread;
        handle_->tell(wrong_);
      }
      if (wrong_ != nullptr && handle_ != nullptr) leave();
    }
    ~Use() {
      if (wrong_ == nullptr) leave();
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

    explicit operator bool() const { return wrong_ == nullptr; }
    [[nodiscard]] const char* wrong() const { return wrong_; }
    Held* operator->() const { return handle_->held_.load(); }
    Held& operator*() const { return *handle_->held_.load(); }
    /// Leaves a line of static storage for message().
    sf_status refuse(const char* why) const {
      handle_->tell(why);
      return SF_BAD_INPUT;
    }
    sf_status fail(const char* why) const {
      handle_->tell(why);
      return SF_FAILED;
    }

   private:
    void leave() noexcept {
      if (wrong_ == nullptr && kind_ == kAlone) handle_->alone_.store(false);
      if (handle_->uses_.fetch_sub(1) == (kEnded | 1)) handle_->give_back();
    }
    const Handle* handle_;
    Kind kind_;
    const char* wrong_ = nullptr;
  };

  /// The newest line left by a call; for people.
  static const char* message(const Handle* handle) noexcept {
    if (handle == nullptr) return "the handle is NULL";
    return (handle->uses_.load() & kEnded) != 0 ? kHasEnded : handle->message_.load();
  }

 private:
  static constexpr std::uint32_t kEnded = 1u << 31;
  static constexpr const char* kHasEnded = "the handle has ended: it was destroyed before";

  void tell(const char* why) const noexcept { message_.store(why); }
  void give_back() const noexcept { delete held_.exchange(nullptr); }
  /// Handles that are reachable are no leak to those who look for leaks.
  static void keep(Handle* handle) noexcept {
    static std::atomic<Handle*> newest{nullptr};
    handle->before_ = newest.load();
    while (!newest.compare_exchange_weak(handle->before_, handle)) {
    }
  }

  mutable std::atomic<Held*> held_;
  mutable std::atomic<std::uint32_t> uses_{0};  ///< calls inside, and kEnded
  mutable std::atomic<bool> alone_{false};
  mutable std::atomic<const char*> message_{""};
  Handle* before_ = nullptr;
};

}  // namespace softfinger
