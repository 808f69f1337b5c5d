#include "softfinger/study/journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <regex>
#include <span>

#include "softfinger/base/error.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/study/journal_file.hpp"
#include "softfinger/study/journal_lock.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

std::int64_t check_of(std::uint64_t key, std::string_view outcome) {
  Hash hash;
  hash.add(key).add(std::span<const char>(outcome));
  return std::bit_cast<std::int64_t>(hash.value());
}

std::string_view bytes_of(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

/// A name that is free, for a journal that is damaged.
fs::path set_aside_name(const fs::path& journal) {
  for (int k = 1;; ++k) {
    fs::path name =
        journal.parent_path() / fmt::format("{}-damaged-{}.sqlite", journal.stem().string(), k);
    std::error_code error;
    if (!fs::exists(name, error)) return name;
  }
}

/// What makes a database whole lies beside it as well.
void rename_database(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const char* end : {"", "-wal", "-shm"}) {
    fs::rename(from.string() + end, to.string() + end, error);
  }
}

void remove_database(const fs::path& file) {
  std::error_code error;
  for (const char* end : {"", "-wal", "-shm"}) fs::remove(file.string() + end, error);
  fs::remove(JournalLock::file_of(file), error);
}

/// What one file holds, as far as it can be read.
struct Held {
  std::map<std::string, std::string> facts;
  std::vector<std::pair<std::uint64_t, CaseOutcome>> outcomes;
  bool damaged = false;
};

Held held_in(const fs::path& file, SqliteDatabase::Mode mode) {
  Held held;
  try {
    SqliteDatabase database(file, mode);
    database.read_what_is_there();
    SqliteStatement tables(database, "select 1 from sqlite_master");
    if (!tables.next()) return held;  // killed before it had begun
    SqliteStatement facts(database, "select what, value from fact");
    while (facts.next()) held.facts[facts.text(0)] = facts.text(1);
    SqliteStatement rows(database, "select key, outcome, hash from evaluation order by rowid");
    while (rows.next()) {
      const auto key = std::bit_cast<std::uint64_t>(rows.integer(0));
      const std::string_view outcome = rows.bytes(1);
      if (check_of(key, outcome) != rows.integer(2) || outcome.size() < 4) {
        held.damaged = true;
        break;
      }
      held.outcomes.emplace_back(key, CaseOutcome::of_bytes(outcome));
    }
  } catch (const SqliteFailure& failure) {
    if (!failure.damaged) {
      throw OperationError(fmt::format("{}: cannot be read", file.string()));
    }
    held.damaged = true;
  }
  return held;
}

}  // namespace

struct Journal::Files {
  explicit Files(const fs::path& file) : lock(file) {}

  JournalLock lock;
  std::optional<SqliteDatabase> database;
  std::optional<SqliteStatement> insert_outcome, insert_design;
};

std::vector<fs::path> shard_files(const fs::path& folder) {
  static const std::regex kName("journal-[0-9]+-of-[0-9]+\\.sqlite");
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (std::regex_match(entry.path().filename().string(), kName)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

Journal::Journal(const fs::path& folder, const std::optional<Shard>& shard,
                 const std::vector<StudyFact>& facts, const StudyHeadings& headings, const Say& say)
    : folder_(folder),
      file_(folder / (shard ? fmt::format("journal-{}-of-{}.sqlite", shard->number, shard->count)
                            : kJournalName)),
      say_(say),
      facts_(facts) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error)) {
    throw InputError(fmt::format("{}: cannot be made a folder", folder.string()));
  }
  files_ = std::make_unique<Files>(file_);
  if (fs::exists(file_, error)) read(file_, true);
  if (const fs::path whole = folder / kJournalName; shard && fs::exists(whole, error)) {
    read(whole, false);
  }
  try {
    begin(facts, headings);
    if (!shard) merge_shards();
  } catch (const SqliteFailure&) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
  }
}

Journal::~Journal() = default;

void Journal::read(const fs::path& file, bool is_own) {
  // Another's may be written just now.
  Held held = held_in(file, is_own ? SqliteDatabase::Mode::kRollBack : SqliteDatabase::Mode::kRead);
  if (!held.facts.empty()) refuse_other_facts(file, held.facts, facts_);
  for (auto& [key, outcome] : held.outcomes) known_[key] = std::move(outcome);
  if (!held.damaged) return;
  if (!is_own) {
    say_(fmt::format("{}: is damaged; {} outcomes before the damage are taken", file.string(),
                     held.outcomes.size()));
    return;
  }
  const fs::path aside = set_aside_name(file);
  rename_database(file, aside);
  say_(
      fmt::format("{}: is damaged; {} outcomes before the damage are kept, the rest is evaluated "
                  "again; what it was is now {}",
                  file.string(), held.outcomes.size(), aside.filename().string()));
  // Written anew by begin().
}

void Journal::begin(const std::vector<StudyFact>& facts, const StudyHeadings& headings) {
  std::error_code error;
  const bool is_new = !fs::exists(file_, error);
  files_->database.emplace(file_, SqliteDatabase::Mode::kCreate);
  SqliteDatabase& database = *files_->database;
  // A commit that a kill follows stays; only a loss of power may take the last ones.
  database.execute("pragma journal_mode = wal; pragma synchronous = normal;");
  database.execute(fmt::format("pragma application_id = {};", kJournalId).c_str());
  database.execute("begin");
  database.execute(kCreateJournal);
  SqliteStatement insert(database, "insert or replace into fact values (?,?)");
  for (const StudyFact& fact : facts) {
    insert.bind(0, fact.what);
    insert.bind(1, fact.value);
    insert.run();
  }
  write_headings(database, headings);
  files_->insert_outcome.emplace(database, "insert into evaluation values (?,?,?)");
  files_->insert_design.emplace(database, "insert or replace into design values (?,?,?,?)");
  if (is_new) {
    const auto known = std::exchange(known_, {});
    for (const auto& [key, outcome] : known) add(key, outcome);
  }
  database.execute("commit");
}

void Journal::merge_shards() {
  for (const fs::path& file : shard_files(folder_)) {
    {
      const JournalLock lock(file);
      const Held held = held_in(file, SqliteDatabase::Mode::kRollBack);
      if (!held.facts.empty()) refuse_other_facts(file, held.facts, facts_);
      if (held.damaged) {
        say_(fmt::format("{}: is damaged; {} outcomes before the damage are taken", file.string(),
                         held.outcomes.size()));
      }
      files_->database->execute("begin");
      for (const auto& [key, outcome] : held.outcomes) {
        if (find(key) == nullptr) add(key, outcome);
      }
      files_->database->execute("commit");
    }
    remove_database(file);
  }
}

void Journal::look_at_others() {
  for (const fs::path& file : shard_files(folder_)) {
    if (file != file_) read(file, false);
  }
}

const CaseOutcome* Journal::find(std::uint64_t key) const {
  const auto found = known_.find(key);
  return found == known_.end() ? nullptr : &found->second;
}

void Journal::add(std::uint64_t key, const CaseOutcome& outcome) {
  try {
    const std::string bytes = outcome.bytes();
    SqliteStatement& insert = *files_->insert_outcome;
    insert.bind(0, std::bit_cast<std::int64_t>(key));
    insert.bind_blob(1, bytes.data(), bytes.size());
    insert.bind(2, check_of(key, bytes));
    insert.run();
  } catch (const SqliteFailure&) {
    throw OperationError(fmt::format(
        "{}: cannot be written (is there room on the disk?); what is recorded stays, and the same "
        "command goes on from there",
        file_.string()));
  }
  known_[key] = outcome;
}

void Journal::add(const StudyRow& row) {
  try {
    SqliteStatement& insert = *files_->insert_design;
    insert.bind(0, row.number);
    const std::string_view parameters = bytes_of(row.parameters);
    insert.bind_blob(1, parameters.data(), parameters.size());
    const std::string_view quantities = bytes_of(row.quantities);
    insert.bind_blob(2, quantities.data(), quantities.size());
    insert.bind(3, row.reason);
    insert.run();
  } catch (const SqliteFailure&) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
  }
}

void Journal::finish() {
  try {
    files_->database->execute("delete from state; insert into state values (1);");
    files_->insert_outcome.reset();
    files_->insert_design.reset();
  } catch (const SqliteFailure&) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
  }
  try {
    files_->database->execute("pragma journal_mode = delete");  // one file and nothing beside it
  } catch (const SqliteFailure&) {
    return;  // somebody reads it just now
  }
}

}  // namespace softfinger
