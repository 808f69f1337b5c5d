#include "softfinger/recording/sqlite_database.hpp"

#include <fmt/core.h>
#include <sqlite3.h>

#include <limits>
#include <string>

namespace softfinger {
namespace {

void check(int result) {
  if (result == SQLITE_OK || result == SQLITE_DONE || result == SQLITE_ROW) return;
  const int primary = result & 0xff;
  throw SqliteFailure{primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB ||
                      primary == SQLITE_ERROR || primary == SQLITE_SCHEMA};
}

/// The file as the only kind of name that takes parameters.
std::string immutable_uri(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    if (c == '?' || c == '#' || c == '%') {
      uri += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

}  // namespace

SqliteDatabase::SqliteDatabase(const std::filesystem::path& file, Mode mode) {
  const std::string name = mode == Mode::kReadImmutable ? immutable_uri(file) : file.string();
  const int flags = mode == Mode::kCreate          ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE
                    : mode == Mode::kRollBack      ? SQLITE_OPEN_READWRITE
                    : mode == Mode::kCheckpoint    ? SQLITE_OPEN_READWRITE
                    : mode == Mode::kReadImmutable ? SQLITE_OPEN_READONLY | SQLITE_OPEN_URI
                                                   : SQLITE_OPEN_READONLY;
  const int result = sqlite3_open_v2(name.c_str(), &handle_, flags, nullptr);
  if (result != SQLITE_OK) {
    sqlite3_close(handle_);
    handle_ = nullptr;
    check(result);
  }
  if (mode != Mode::kCreate) distrust();
  // A reader may meet the writer's checkpoint; it is short.
  sqlite3_busy_timeout(handle_, mode == Mode::kCheckpoint ? 0 : 2000);
}

/// A recording may be a stranger's (sqlite.org/security.html): no views or triggers, which could
/// run for ever or do more than they say, nothing that its schema asks for beyond plain functions.
void SqliteDatabase::distrust() {
  for (const int off : {SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_TRIGGER,
                        SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION}) {
    sqlite3_db_config(handle_, off, 0, nullptr);
  }
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

SqliteDatabase::~SqliteDatabase() { sqlite3_close_v2(handle_); }

void SqliteDatabase::execute(const char* sql) {
  check(sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr));
}

void SqliteDatabase::read_what_is_there() {
  // What tools that recover databases do; views and triggers stay off.
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
}

void SqliteDatabase::leave_checkpoints_to_others() {
  const auto note_pages = [](void* pages, sqlite3*, const char*, int now) {
    *static_cast<int*>(pages) = now;
    return SQLITE_OK;
  };
  sqlite3_wal_hook(handle_, note_pages, &log_pages_);  // in the place of the one that copies
}

int SqliteDatabase::checkpoint() {
  execute("select 1 from sqlite_master");  // one that has not read knows of no log
  int copied = 0;
  const int result =
      sqlite3_wal_checkpoint_v2(handle_, "main", SQLITE_CHECKPOINT_PASSIVE, nullptr, &copied);
  if (result != SQLITE_BUSY) check(result);
  return copied;
}

bool SqliteDatabase::empty_log() {
  const int result =
      sqlite3_wal_checkpoint_v2(handle_, "main", SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
  if (result == SQLITE_BUSY) return false;
  check(result);
  return true;
}

void SqliteDatabase::sync_file() { sync(SQLITE_FCNTL_FILE_POINTER); }
void SqliteDatabase::sync_log() { sync(SQLITE_FCNTL_JOURNAL_POINTER); }

void SqliteDatabase::sync(int which) {
  sqlite3_file* file = nullptr;
  check(sqlite3_file_control(handle_, "main", which, static_cast<void*>(&file)));
  if (file != nullptr && file->pMethods != nullptr) {
    check(file->pMethods->xSync(file, SQLITE_SYNC_NORMAL));
  }
}

SqliteStatement::SqliteStatement(SqliteDatabase& database, std::string_view sql) {
  check(sqlite3_prepare_v2(database.handle_, sql.data(), static_cast<int>(sql.size()), &handle_,
                           nullptr));
}

SqliteStatement::~SqliteStatement() { sqlite3_finalize(handle_); }

void SqliteStatement::bind(int parameter, double value) {
  check(sqlite3_bind_double(handle_, parameter + 1, value));
}

void SqliteStatement::bind(int parameter, std::int64_t value) {
  check(sqlite3_bind_int64(handle_, parameter + 1, value));
}

void SqliteStatement::bind(int parameter, std::string_view text) {
  check(sqlite3_bind_text64(handle_, parameter + 1, text.data(), text.size(), SQLITE_TRANSIENT,
                            SQLITE_UTF8));
}

void SqliteStatement::bind_blob(int parameter, const void* data, std::size_t size) {
  // No address would make it NULL.
  check(size == 0 ? sqlite3_bind_zeroblob(handle_, parameter + 1, 0)
                  : sqlite3_bind_blob64(handle_, parameter + 1, data, size, SQLITE_TRANSIENT));
}

void SqliteStatement::bind_null(int parameter) { check(sqlite3_bind_null(handle_, parameter + 1)); }

void SqliteStatement::run() {
  const int result = sqlite3_step(handle_);
  sqlite3_reset(handle_);
  check(result);
}

bool SqliteStatement::next() {
  const int result = sqlite3_step(handle_);
  if (result == SQLITE_ROW) return true;
  sqlite3_reset(handle_);
  check(result);
  return false;
}

int SqliteStatement::columns() const { return sqlite3_column_count(handle_); }

double SqliteStatement::number(int column) const {
  if (is_null(column)) return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(handle_, column);
}

std::int64_t SqliteStatement::integer(int column) const {
  return sqlite3_column_int64(handle_, column);
}

std::string SqliteStatement::text(int column) const { return std::string(bytes(column)); }

std::string_view SqliteStatement::bytes(int column) const {
  const void* data = sqlite3_column_blob(handle_, column);
  const int size = sqlite3_column_bytes(handle_, column);
  return {static_cast<const char*>(data), static_cast<std::size_t>(size)};
}

bool SqliteStatement::is_null(int column) const {
  return sqlite3_column_type(handle_, column) == SQLITE_NULL;
}

}  // namespace softfinger
