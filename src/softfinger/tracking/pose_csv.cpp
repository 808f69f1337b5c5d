#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/tracking/csv_tracker.hpp"

namespace softfinger {

namespace {

constexpr std::string_view kHeader = "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz";
constexpr std::array<std::string_view, 8> kColumns{"time_s", "x_mm", "y_mm", "z_mm",
                                                   "qw",     "qx",   "qy",   "qz"};
constexpr double kMaxTime = 1e6;      // s
constexpr double kMaxPosition = 1e5;  // mm: 100 m
constexpr double kNormTolerance = 0.01;
constexpr std::size_t kMaxFileSize = std::size_t{1} << 30;  // bytes: hours at 1 kHz
constexpr std::size_t kMaxShown = 40;                       // characters of the file in a message

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Part of the file inside a one-line message.
std::string shown(std::string_view text) {
  std::string result(text.substr(0, kMaxShown));
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  return text.size() > kMaxShown ? result + "..." : result;
}

/// One line of the file and where it is.
struct Line {
  const std::filesystem::path& file;
  std::size_t number = 0;
  std::string_view text;

  [[noreturn]] void fail(std::string_view column, std::string_view message) const {
    throw InputError(fmt::format("{}:{}: {}{}{}", file.string(), number, column,
                                 column.empty() ? "" : ": ", message));
  }
};

std::array<double, 8> read_numbers(const Line& line) {
  std::array<double, 8> values{};
  std::string_view rest = line.text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t comma = rest.find(',');
    const bool last = i + 1 == values.size();
    if (last != (comma == std::string_view::npos)) {
      line.fail("", fmt::format("expected {} numbers separated by commas", values.size()));
    }
    const std::string_view field = trimmed(rest.substr(0, comma));
    const char* const end = field.data() + field.size();
    const auto [stop, error] = std::from_chars(field.data(), end, values[i]);
    if (error != std::errc() || stop != end || !std::isfinite(values[i])) {
      line.fail(kColumns[i], fmt::format("expected a finite number, found '{}'", shown(field)));
    }
    const double limit = i == 0 ? kMaxTime : i < 4 ? kMaxPosition : 2.0;
    if (std::abs(values[i]) > limit) {
      line.fail(kColumns[i],
                fmt::format("must be between {} and {}, found {}", -limit, limit, values[i]));
    }
    if (!last) rest.remove_prefix(comma + 1);
  }
  return values;
}

PoseSample read_row(const Line& line) {
  const auto v = read_numbers(line);
  PoseSample row{.time = v[0],
                 .p_WFt = Vector3(v[1], v[2], v[3]) * mm,
                 .rotation_WFt = Eigen::Quaterniond(v[4], v[5], v[6], v[7])};
  const double norm = row.rotation_WFt.norm();
  if (!(std::abs(norm - 1.0) <= kNormTolerance)) {
    line.fail("qw", fmt::format("the quaternion qw,qx,qy,qz must have norm 1, found {:.6g}", norm));
  }
  row.rotation_WFt.normalize();
  return row;
}

}  // namespace

std::vector<PoseSample> read_pose_csv(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, kMaxFileSize);
  std::string_view rest = text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);  // byte order mark
  std::vector<PoseSample> rows;
  bool header_seen = false;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const Line line{file, number, trimmed(rest.substr(0, end))};
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!header_seen) {
      if (line.text != kHeader) {
        line.fail("", fmt::format("expected the header {}, found '{}'", kHeader, shown(line.text)));
      }
      header_seen = true;
    } else if (!line.text.empty()) {
      rows.push_back(read_row(line));
      if (rows.size() > 1 && !(rows.back().time > rows[rows.size() - 2].time)) {
        line.fail("time_s", fmt::format("times must increase, found {} after {}", rows.back().time,
                                        rows[rows.size() - 2].time));
      }
    }
  }
  if (rows.empty()) {
    throw InputError(fmt::format("{}: no poses; expected the header {} and at least one row",
                                 file.string(), kHeader));
  }
  return rows;
}

}  // namespace softfinger
