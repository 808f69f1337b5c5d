#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace softfinger {

/// What every call of SqliteDatabase and SqliteStatement throws when the file does not allow it.
/// The message names no library; callers turn it into an InputError or OperationError.
struct SqliteFailure {
  bool damaged = false;  ///< the file is no database or is damaged
};

/// An open SQLite file.
class SqliteDatabase {
 public:
  enum class Mode {
    kRead,
    kReadImmutable,  ///< nothing is made beside the file, nothing beside it is read, nobody writes
                     ///< it
    kRollBack,       ///< what a journal beside it says is done first
    kCreate,
    kCheckpoint  ///< for who copies its log, and waits for nobody who reads
  };
  SqliteDatabase(const std::filesystem::path& file, Mode mode);
  ~SqliteDatabase();
  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  /// Runs statements that return nothing of interest.
  void execute(const char* sql);

  /// A file that is shorter than it says is read as far as it goes; without this nothing of it is.
  void read_what_is_there();
  /// Commits of this connection do not copy the write-ahead log, however long it gets.
  void leave_checkpoints_to_others();
  /// Pages that the log had at the last commit after that.
  [[nodiscard]] int log_pages() const { return log_pages_; }

  /// Copies what nobody reads of the write-ahead log into the file, with a sync of the log before
  /// and, unless it grows meanwhile, one of the file after.
  /// \returns pages of the log that are in the file.
  [[nodiscard]] int checkpoint();
  /// Truncates a log that is in the file as a whole. False: somebody reads in it.
  [[nodiscard]] bool empty_log();
  void sync_file();
  void sync_log();

 private:
  friend class SqliteStatement;
  void distrust();
  void sync(int which);
  sqlite3* handle_ = nullptr;
  int log_pages_ = 0;
};

/// A prepared statement; parameters and columns count from 0. NaN is stored as NULL and read back
/// as NaN.
class SqliteStatement {
 public:
  SqliteStatement(SqliteDatabase& database, std::string_view sql);
  ~SqliteStatement();
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  void bind(int parameter, double value);
  void bind(int parameter, std::int64_t value);
  void bind(int parameter, std::string_view text);
  void bind_blob(int parameter, const void* data, std::size_t size);
  void bind_null(int parameter);

  /// Executes a statement without result and makes it ready for the next bindings.
  void run();
  /// Next row of a query; false at the end, after which the query may be bound and stepped again.
  bool next();

  [[nodiscard]] int columns() const;  ///< of a row
  [[nodiscard]] double number(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] std::string text(int column) const;
  /// Bytes of a blob or text; valid until the next next().
  [[nodiscard]] std::string_view bytes(int column) const;
  [[nodiscard]] bool is_null(int column) const;

 private:
  sqlite3_stmt* handle_ = nullptr;
};

}  // namespace softfinger
