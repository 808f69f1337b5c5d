#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace softfinger {

/// One CSV file written field by field, without any locale.
class CsvWriter {
 public:
  /// Creates the file with its header line. Throws InputError where it exists.
  CsvWriter(const std::filesystem::path& file, std::string_view header);
  ~CsvWriter();
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  /// A number that is not finite is a missing value.
  void field(double value);
  void field(std::int64_t value);
  void field(std::string_view text);
  void missing(int fields = 1);
  void end_row();
  /// Throws OperationError where something could not be written, as end_row() does.
  void close();

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
