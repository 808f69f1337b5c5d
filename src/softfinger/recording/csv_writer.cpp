#include "softfinger/recording/csv_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "softfinger/base/error.hpp"

namespace softfinger {

CsvWriter::CsvWriter(const std::filesystem::path& file, const std::vector<TableColumn>& columns)
    : file_(file) {
  if (std::filesystem::exists(file)) {
    throw InputError(fmt::format("{}: exists already; export into a new directory", file.string()));
  }
  stream_ = std::fopen(file.c_str(), "w");
  if (stream_ == nullptr) throw OperationError(fmt::format("{}: cannot be written", file.string()));
  for (const TableColumn& column : columns) words(column.name);
  end_row();
}

CsvWriter::~CsvWriter() {
  if (stream_ != nullptr) std::fclose(stream_);
}

void CsvWriter::number(double value) {
  separate();
  // Adding 0 takes the sign from a negative zero.
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(line_), "{:.12g}", value + 0.0);
}

void CsvWriter::words(std::string_view text) {
  separate();
  const bool quoted = text.find_first_of(",\"\n\r") != std::string_view::npos;
  if (quoted) line_.push_back('"');
  for (const char c : text) {
    if (c == '"') line_.push_back('"');
    line_.push_back(c);
  }
  if (quoted) line_.push_back('"');
}

void CsvWriter::end_row() {
  line_.push_back('\n');
  first_ = true;
  if (line_.size() > 60'000) flush();
}

void CsvWriter::close() {
  flush();
  const bool failed = std::fclose(stream_) != 0;
  stream_ = nullptr;
  if (failed) fail();
}

void CsvWriter::separate() {
  if (!first_) line_.push_back(',');
  first_ = false;
}

void CsvWriter::flush() {
  if (std::fwrite(line_.data(), 1, line_.size(), stream_) != line_.size()) fail();
  line_.clear();
}

void CsvWriter::fail() const {
  throw OperationError(
      fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
}

}  // namespace softfinger
