#include "softfinger/study/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <ostream>
#include <string_view>

#include "softfinger/base/error.hpp"
#include "softfinger/files/toml_text.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/recording/csv_writer.hpp"
#include "softfinger/study/journal_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLogFlag = 1;
constexpr std::int64_t kTiedFlag = 2;
constexpr std::int64_t kMaximiseFlag = 1;

std::vector<double> doubles_of(std::string_view bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

StudyTable read_table(SqliteDatabase& database) {
  StudyTable table;
  table.headings = read_headings(database);
  SqliteStatement rows(database,
                       "select number, parameters, quantities, reason from design order by number");
  while (rows.next()) {
    StudyRow row{.number = rows.integer(0),
                 .parameters = doubles_of(rows.bytes(1)),
                 .quantities = doubles_of(rows.bytes(2)),
                 .reason = rows.text(3)};
    if (row.parameters.size() != table.headings.parameters.size() ||
        row.quantities.size() != table.headings.quantities.size()) {
      throw SqliteFailure{true};
    }
    table.rows.push_back(std::move(row));
  }
  SqliteStatement state(database, "select finished from state");
  table.finished = state.next() && state.integer(0) != 0;
  return table;
}

}  // namespace

void write_headings(SqliteDatabase& database, const StudyHeadings& headings) {
  database.execute("delete from heading");
  SqliteStatement insert(database, "insert into heading values (?,?,?,?,?)");
  std::int64_t number = 0;
  const auto add = [&](std::string_view role, const std::string& name, const std::string& what,
                       std::int64_t flags) {
    insert.bind(0, number++);
    insert.bind(1, role);
    insert.bind(2, name);
    insert.bind(3, what);
    insert.bind(4, flags);
    insert.run();
  };
  add("title", headings.title, "", 0);
  add("kind", headings.kind, "", 0);
  add("device", headings.device, headings.device_text, 0);
  for (const auto& parameter : headings.parameters) {
    add("parameter", parameter.key, "",
        (parameter.log ? kLogFlag : 0) | (parameter.tied ? kTiedFlag : 0));
  }
  for (const auto& quantity : headings.quantities) {
    add(quantity.objective ? "objective" : "constraint", quantity.name, quantity.what,
        quantity.maximise ? kMaximiseFlag : 0);
  }
}

StudyHeadings read_headings(SqliteDatabase& database) {
  StudyHeadings headings;
  SqliteStatement rows(database, "select role, name, what, flag from heading order by number");
  while (rows.next()) {
    const std::string role = rows.text(0);
    const std::string name = rows.text(1);
    const std::int64_t flags = rows.integer(3);
    if (role == "title") headings.title = name;
    if (role == "kind") headings.kind = name;
    if (role == "device") {
      headings.device = name;
      headings.device_text = rows.text(2);
    }
    if (role == "parameter") {
      headings.parameters.push_back({name, (flags & kLogFlag) != 0, (flags & kTiedFlag) != 0});
    }
    if (role == "objective" || role == "constraint") {
      headings.quantities.push_back(
          {name, rows.text(2), role == "objective", (flags & kMaximiseFlag) != 0});
    }
  }
  return headings;
}

StudyTable read_study_table(const fs::path& folder) {
  const fs::path file = folder / kJournalName;
  std::error_code error;
  if (!fs::exists(file, error)) {
    if (!shard_files(folder).empty()) {
      throw InputError(
          fmt::format("{}: has shards alone; softfinger study without --shard takes "
                      "them together and finishes",
                      folder.string()));
    }
    throw InputError(fmt::format("{}: has no {}; expected what softfinger study --out made",
                                 folder.string(), kJournalName));
  }
  try {
    SqliteDatabase database(file, SqliteDatabase::Mode::kRead);
    return read_table(database);
  } catch (const SqliteFailure& failure) {
    throw InputError(fmt::format("{}: {}", file.string(),
                                 failure.damaged ? "is damaged; run the study once more, which "
                                                   "keeps what can be read of it"
                                                 : "cannot be read"));
  }
}

std::vector<TableColumn> study_columns(const StudyTable& table) {
  std::vector<TableColumn> columns{{.name = "design"}};
  for (const auto& parameter : table.headings.parameters)
    columns.push_back({.name = parameter.key});
  for (const auto& quantity : table.headings.quantities) columns.push_back({.name = quantity.name});
  columns.push_back({.name = "feasible", .words = true});
  columns.push_back({.name = "reason", .words = true});
  return columns;
}

void write_study(const StudyTable& table, TableWriter& writer) {
  for (const StudyRow& row : table.rows) {
    writer.number(static_cast<double>(row.number));
    for (const double value : row.parameters) writer.number(value);
    for (const double value : row.quantities) writer.number(value);
    writer.words(row.feasible() ? "true" : "false");
    writer.words(row.reason);
    writer.end_row();
  }
  writer.close();
}

void export_study(const StudyTable& table, const fs::path& file) {
  CsvWriter writer(file, study_columns(table));
  write_study(table, writer);
}

void export_device(const StudyTable& table, std::int64_t design, const fs::path& file) {
  const auto row = std::ranges::find(table.rows, design, &StudyRow::number);
  if (row == table.rows.end()) {
    throw InputError(
        fmt::format("there is no design {}; {} are done, from 0 on", design, table.rows.size()));
  }
  std::error_code error;
  if (fs::exists(file, error)) throw InputError(fmt::format("{}: exists already", file.string()));
  TomlText text(table.headings.device, table.headings.device_text);
  constexpr std::string_view kDevice = "device.";
  std::vector<std::pair<std::string, double>> numbers;
  for (std::size_t k = 0; k < row->parameters.size(); ++k) {
    const std::string& key = table.headings.parameters[k].key;
    if (!key.starts_with(kDevice)) continue;
    numbers.emplace_back(key.substr(kDevice.size()), row->parameters[k]);
    static_cast<void>(text.add(numbers.back().first, row->parameters[k]));
  }
  const std::string changed = text.with(numbers);
  if (!write_file_whole(file, [&](std::ostream& stream) {
        stream << fmt::format("# Design {} of study {}, from {}.\n", design, table.headings.title,
                              table.headings.device)
               << changed;
      })) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file.string()));
  }
}

}  // namespace softfinger
