#include "softfinger/c_interface/table.hpp"

#include "softfinger/c_interface/answers.hpp"

namespace softfinger {
namespace {

using TableUse = Handle<Table>::Use;

const Table::Column* column_at(const TableUse& use, std::size_t column) {
  return use && column < use->columns.size() ? &use->columns[column] : nullptr;
}

}  // namespace
}  // namespace softfinger

using softfinger::TableUse;

void sf_table_destroy(sf_table* table) {
  if (table != nullptr) table->destroy();
}

sf_status sf_table_size(const sf_table* table, size_t* rows, size_t* columns) {
  const TableUse use(table, TableUse::kAnyThread);
  if (!use) return SF_BAD_INPUT;
  if (rows != nullptr) *rows = use->columns.empty() ? 0 : use->columns.front().values.size();
  if (columns != nullptr) *columns = use->columns.size();
  return SF_DONE;
}

sf_status sf_table_name(const sf_table* table, size_t column, char* name, size_t capacity,
                        size_t* count) {
  const TableUse use(table, TableUse::kAnyThread);
  const softfinger::Table::Column* found = softfinger::column_at(use, column);
  if (found == nullptr) return SF_BAD_INPUT;
  softfinger::copy_text(found->name, name, capacity, count);
  return SF_DONE;
}

sf_status sf_table_column(const sf_table* table, size_t column, double* values, size_t capacity,
                          size_t* count) {
  const TableUse use(table, TableUse::kAnyThread);
  const softfinger::Table::Column* found = softfinger::column_at(use, column);
  if (found == nullptr) return SF_BAD_INPUT;
  softfinger::copy_out(found->values.size(), values, capacity, count,
                       [&](std::size_t i) { return found->values[i]; });
  return SF_DONE;
}

sf_status sf_table_text(const sf_table* table, char* text, size_t capacity, size_t* count) {
  const TableUse use(table, TableUse::kAnyThread);
  if (!use) return SF_BAD_INPUT;
  softfinger::copy_text(use->text, text, capacity, count);
  return SF_DONE;
}

sf_status sf_table_unit(const sf_table* table, size_t column, char* unit, size_t capacity,
                        size_t* count) {
  const TableUse use(table, TableUse::kAnyThread);
  const softfinger::Table::Column* found = softfinger::column_at(use, column);
  if (found == nullptr) return SF_BAD_INPUT;
  softfinger::copy_text(found->unit, unit, capacity, count);
  return SF_DONE;
}

sf_status sf_table_word(const sf_table* table, size_t column, size_t number, char* word,
                        size_t capacity, size_t* count) {
  const TableUse use(table, TableUse::kAnyThread);
  const softfinger::Table::Column* found = softfinger::column_at(use, column);
  if (found == nullptr || number >= found->words.size()) return SF_BAD_INPUT;
  softfinger::copy_text(found->words[number], word, capacity, count);
  return SF_DONE;
}
