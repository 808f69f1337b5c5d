#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/c_interface/table.hpp"
#include "softfinger/recording/table.hpp"

namespace softfinger {

/// Fills a table's columns row by row.
class TableCollector : public TableWriter {
 public:
  TableCollector(Table& table, const std::vector<TableColumn>& columns)
      : table_(table), numbers_(columns.size()) {
    for (const TableColumn& column : columns) {
      table.add_column(column.name);
      if (!column.unit.empty()) table.columns.back().unit = column.unit;
      if (column.words) table.columns.back().unit.clear();
    }
  }

  void number(double value) override { table_.columns.at(next_++).values.push_back(value); }
  void words(std::string_view text) override {
    Table::Column& column = table_.columns.at(next_);
    const auto [at, is_new] =
        numbers_.at(next_).try_emplace(std::string(text), column.words.size());
    if (is_new) column.words.emplace_back(text);
    column.values.push_back(static_cast<double>(at->second));
    ++next_;
  }
  void end_row() override { next_ = 0; }
  void close() override {}

 private:
  Table& table_;
  std::vector<std::map<std::string, std::size_t>> numbers_;  ///< of words, by column
  std::size_t next_ = 0;
};

/// Keeps one of the tables that are written, and the names of all.
class OneTable : public TableStore {
 public:
  OneTable(Table& table, std::string wanted) : table_(table), wanted_(std::move(wanted)) {}

  std::unique_ptr<TableWriter> open(const std::string& name,
                                    const std::vector<TableColumn>& columns) override {
    names_.push_back(name);
    if (name != wanted_) return std::make_unique<Nowhere>();
    return std::make_unique<TableCollector>(table_, columns);
  }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  class Nowhere : public TableWriter {
    void number(double) override {}
    void words(std::string_view) override {}
    void end_row() override {}
    void close() override {}
  };

  Table& table_;
  std::string wanted_;
  std::vector<std::string> names_;
};

}  // namespace softfinger
