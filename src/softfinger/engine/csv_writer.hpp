#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "softfinger/base/error.hpp"

namespace softfinger {

/// One CSV file written field by field, without any locale. For .cpp files only.
class CsvWriter {
 public:
  /// Creates the file with its header line. Throws InputError where it exists.
  CsvWriter(const std::filesystem::path& file, std::string_view header) : file_(file) {
    if (std::filesystem::exists(file)) {
      throw InputError(
          fmt::format("{}: exists already; export into a new directory", file.string()));
    }
    stream_ = std::fopen(file.c_str(), "w");
    if (stream_ == nullptr)
      throw OperationError(fmt::format("{}: cannot be written", file.string()));
    fmt::format_to(std::back_inserter(line_), "{}\n", header);
  }
  ~CsvWriter() {
    if (stream_ != nullptr) std::fclose(stream_);
  }
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  /// A number that is not finite is a missing value.
  void field(double value) {
    separate();
    // Adding 0 takes the sign from a negative zero.
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(line_), "{:.12g}", value + 0.0);
  }
  void field(std::int64_t value) {
    separate();
    fmt::format_to(std::back_inserter(line_), "{}", value);
  }
  void field(std::string_view text) {
    separate();
    const bool quoted = text.find_first_of(",\"\n\r") != std::string_view::npos;
    if (quoted) line_.push_back('"');
    for (const char c : text) {
      if (c == '"') line_.push_back('"');
      line_.push_back(c);
    }
    if (quoted) line_.push_back('"');
  }
  void missing(int fields = 1) {
    for (int i = 0; i < fields; ++i) separate();
  }
  void end_row() {
    line_.push_back('\n');
    first_ = true;
    if (line_.size() > 60'000) flush();
  }
  void close() {
    flush();
    const bool failed = std::fclose(stream_) != 0;
    stream_ = nullptr;
    if (failed) fail();
  }

 private:
  void separate() {
    if (!first_) line_.push_back(',');
    first_ = false;
  }
  void flush() {
    if (std::fwrite(line_.data(), 1, line_.size(), stream_) != line_.size()) fail();
    line_.clear();
  }
  [[noreturn]] void fail() const {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
  }

  std::filesystem::path file_;
  std::FILE* stream_ = nullptr;
  fmt::memory_buffer line_;
  bool first_ = true;
};

}  // namespace softfinger
