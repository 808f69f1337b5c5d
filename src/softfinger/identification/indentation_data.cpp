#include "softfinger/identification/indentation_data.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/text_file.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMaxBytes = 4 << 20;
constexpr std::size_t kMaxRows = 10000;
constexpr std::size_t kShownLetters = 40;

using Header = std::array<std::string_view, 2>;

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

/// For messages: short, and without what would break a line or a terminal.
std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, kShownLetters)) {
    result += c >= ' ' && c < '\x7f' ? c : '?';
  }
  return text.size() > kShownLetters ? result + "..." : result;
}

std::optional<double> number(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, const Header& header) : header_(header) {
    columns_.file = file;
  }

  MeasuredColumns read() {
    const std::string text = read_text_file(columns_.file, kMaxBytes);
    std::string_view rest = text;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    if (trimmed(rest).empty()) {
      throw InputError(fmt::format("{}: is empty, expected the header {},{}",
                                   columns_.file.string(), header_[0], header_[1]));
    }
    bool header_read = false;
    while (!rest.empty()) {
      ++line_;
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = trimmed(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (!header_read) {
        check_header(line);
        header_read = true;
      } else if (!line.empty()) {
        read_row(line);
      }
    }
    return std::move(columns_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}:{}: {}", columns_.file.string(), line_, message));
  }

  void check_header(std::string_view line) const {
    const std::vector<std::string_view> names = fields_of(line);
    const std::string right = fmt::format("expected {},{}", header_[0], header_[1]);
    if (names.size() != 2) {
      fail(fmt::format("header '{}' has {} columns, {}", shown(line), names.size(), right));
    }
    for (std::size_t k = 0; k < 2; ++k) {
      if (names[k] == header_[k]) continue;
      const std::string_view quantity = header_[k].substr(0, header_[k].rfind('_'));
      const bool wrong_unit = names[k].substr(0, names[k].find('_')) == quantity;
      fail(fmt::format("header: column {} is '{}'{}, {}", k + 1, shown(names[k]),
                       wrong_unit ? ": another unit" : "", right));
    }
  }

  void read_row(std::string_view line) {
    const std::vector<std::string_view> fields = fields_of(line);
    if (fields.size() != 2) {
      fail(fmt::format("has {} columns, expected {},{}", fields.size(), header_[0], header_[1]));
    }
    std::array<double, 2> values{};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto value = number(fields[k]);
      if (!value) {
        fail(fmt::format("{}: '{}' is not a number", header_[k], shown(fields[k])));
      }
      if (*value < 0.0) {
        fail(fmt::format("{}: {} is negative, expected 0 or more", header_[k], *value));
      }
      values[k] = *value * unit_scale(header_[k]);
    }
    if (columns_.lines.size() >= kMaxRows) fail(fmt::format("more than {} rows", kMaxRows));
    columns_.first.push_back(values[0]);
    columns_.second.push_back(values[1]);
    columns_.lines.push_back(line_);
  }

  Header header_;
  MeasuredColumns columns_;
  int line_ = 0;
};

}  // namespace

void MeasuredColumns::fail(std::size_t row, const std::string& message) const {
  throw InputError(fmt::format("{}:{}: {}", file.string(), lines[row], message));
}

MeasuredColumns read_indentation_curve(const std::filesystem::path& file) {
  MeasuredColumns curve = Reader(file, {"indentation_mm", "force_N"}).read();
  int deep = 0;
  for (std::size_t i = 0; i < curve.lines.size(); ++i) {
    if (i > 0 && curve.first[i] <= curve.first[i - 1]) {
      curve.fail(i,
                 fmt::format("indentation_mm: {:.6g} does not exceed the {:.6g} of the row before; "
                             "expected one loading, depths rising",
                             curve.first[i] / mm, curve.first[i - 1] / mm));
    }
    deep += curve.first[i] > 0.0 && curve.second[i] > 0.0 ? 1 : 0;
  }
  if (deep < kLeastRows) {
    throw InputError(
        fmt::format("{}:{}: too few points: {} with depth and force above 0, expected "
                    "at least {}",
                    file.string(), curve.lines.empty() ? 1 : curve.lines.back(), deep, kLeastRows));
  }
  return curve;
}

MeasuredColumns read_contact_areas(const std::filesystem::path& file) {
  MeasuredColumns areas = Reader(file, {"force_N", "area_mm2"}).read();
  for (std::size_t i = 0; i < areas.lines.size(); ++i) {
    if (areas.first[i] > 0.0 && areas.second[i] > 0.0) continue;
    areas.fail(i, "force_N and area_mm2 must be above 0");
  }
  if (areas.lines.size() < 3) {
    throw InputError(fmt::format("{}:{}: too few points: {}, expected at least 3", file.string(),
                                 areas.lines.empty() ? 1 : areas.lines.back(), areas.lines.size()));
  }
  return areas;
}

}  // namespace softfinger
