#include "softfinger/recording/checkpointer.hpp"

#include <algorithm>
#include <utility>

#include "softfinger/recording/sqlite_database.hpp"

namespace softfinger {

/// The log, by connections that nobody waits for.
class Checkpointer::Log {
 public:
  explicit Log(const std::filesystem::path& file)
      : copier_(file, SqliteDatabase::Mode::kCheckpoint),
        reader_(file, SqliteDatabase::Mode::kCheckpoint) {}

  /// Copies what it has now, with syncs. Somebody who reads keeps the writer from beginning it
  /// anew as soon as it is copied, which takes a sync of its header. That takes a log that is not
  /// copied to its end: who reads one that is reads in the file.
  int copy() {
    release();
    reader_.execute("begin; select 1 from sqlite_master");
    is_kept_ = true;
    return copier_.checkpoint();
  }
  void sync_file() { copier_.sync_file(); }

  /// Takes no sync where all of it is copied. False: somebody else reads in it.
  [[nodiscard]] bool empty() {
    release();
    return copier_.empty_log();
  }
  void sync() { copier_.sync_log(); }

 private:
  void release() {
    if (std::exchange(is_kept_, false)) reader_.execute("commit");
  }

  SqliteDatabase copier_, reader_;
  bool is_kept_ = false;
};

Checkpointer::Checkpointer(std::filesystem::path file, LogLimits limits)
    : file_(std::move(file)),
      limits_(limits),
      copy_at_(limits.copied_each),
      empty_at_(limits.copied_each) {
  thread_ = std::thread([this] { run(); });
}

void Checkpointer::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Checkpointer::Begin Checkpointer::begin() {
  {
    const std::lock_guard lock(mutex_);
    if (must_rest()) return Begin::kLater;
  }
  return begin_at_once();
}

bool Checkpointer::must_rest() {
  using Clock = std::chrono::steady_clock;
  if (!rest_wanted_) return false;
  if (!resting_since_) resting_since_ = Clock::now();
  if (Clock::now() - *resting_since_ < std::chrono::duration<double>(kMostRest)) return true;
  if (pages_ < limits_.longest) return false;
  held_up_ = true;
  return true;
}

Checkpointer::Begin Checkpointer::begin_at_once() {
  const std::lock_guard lock(mutex_);
  writing_ = true;
  rest_wanted_ = false;
  resting_since_.reset();
  return std::exchange(log_is_empty_, false) ? Begin::kInEmptyLog : Begin::kNow;
}

void Checkpointer::committed(int log_pages) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    pages_ = log_pages;
  }
  changed_.notify_all();
}

void Checkpointer::run() {
  try {
    Lock lock(mutex_);
    changed_.wait(lock, [&] { return stopping_ || pages_ >= copy_at_; });
    if (stopping_) return;
    lock.unlock();
    Log log(file_);
    lock.lock();
    follow_log(log, lock);
  } catch (const SqliteFailure&) {
    // After a sync that failed another one proves nothing: the log stays.
    const std::lock_guard lock(mutex_);
    rest_wanted_ = false;
  }
}

void Checkpointer::follow_log(Log& log, Lock& lock) {
  while (!stopping_) {
    copy(log, lock);
    if (pages_ >= empty_at_) {
      rest_wanted_ = true;
      copy_rest(log, lock);
      if (!empty(log, lock)) {
        empty_at_ = pages_ < limits_.longest ? std::min(2 * pages_, limits_.longest) : 2 * pages_;
      }
      rest_wanted_ = false;
    }
    changed_.wait(lock, [&] { return stopping_ || pages_ >= copy_at_; });
  }
}

/// Most of the work, beside a writer who goes on.
void Checkpointer::copy(Log& log, Lock& lock) {
  const int pages = pages_;
  lock.unlock();
  copied_ = log.copy();
  log.sync_file();  // SQLite does not, where the log has grown meanwhile
  lock.lock();
  copy_at_ = std::max(pages, copied_) + limits_.copied_each;
}

/// While the writer rests.
void Checkpointer::copy_rest(Log& log, Lock& lock) {
  changed_.wait(lock, [&] { return stopping_ || !writing_; });
  if (stopping_ || copied_ == pages_) return;
  lock.unlock();
  copied_ = log.copy();
  lock.lock();
}

/// If the writer has not begun meanwhile; with the lock he does not.
bool Checkpointer::empty(Log& log, Lock& lock) {
  if (stopping_ || !rest_wanted_ || copied_ != pages_ || !log.empty()) return false;
  log_is_empty_ = true;
  pages_ = copied_ = 0;
  copy_at_ = empty_at_ = limits_.copied_each;
  lock.unlock();
  // A writer who rests no longer may write to it all the same: a file that was truncated gets new
  // blocks, and its old ones do not come back once it has them.
  log.sync();
  lock.lock();
  return true;
}

}  // namespace softfinger
