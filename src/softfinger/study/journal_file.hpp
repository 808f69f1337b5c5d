#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {

// How a journal lies in its SQLite file; for who writes and who reads it.

inline constexpr const char* kJournalName = "journal.sqlite";
inline constexpr std::int64_t kJournalId = 0x73667374;  ///< application_id: "sfst"

inline constexpr const char* kCreateJournal =
    "create table if not exists fact (what text primary key, value text);"
    "create table if not exists evaluation (key integer, outcome blob, hash integer);"
    "create table if not exists heading (number integer primary key, role text, name text,"
    " what text, flag integer);"
    "create table if not exists design (number integer primary key, parameters blob,"
    " quantities blob, reason text);"
    "create table if not exists state (finished integer);";

/// Whether it is there: a name of a shard's or the whole study's.
[[nodiscard]] std::vector<std::filesystem::path> shard_files(const std::filesystem::path& folder);

void write_headings(SqliteDatabase& database, const StudyHeadings& headings);
[[nodiscard]] StudyHeadings read_headings(SqliteDatabase& database);

}  // namespace softfinger
