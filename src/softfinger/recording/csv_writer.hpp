#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/recording/table.hpp"

namespace softfinger {

/// One CSV file written field by field, without any locale.
class CsvWriter : public TableWriter {
 public:
  /// Creates the file with its header line. Throws InputError where it exists.
  CsvWriter(const std::filesystem::path& file, const std::vector<TableColumn>& columns);
  ~CsvWriter() override;
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  void number(double value) override;  ///< twelve digits
  void words(std::string_view text) override;
  void end_row() override;
  void close() override;

 private:
  void separate();
  void flush();
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::FILE* stream_ = nullptr;
  std::string line_;
  bool first_ = true;
};

}  // namespace softfinger
