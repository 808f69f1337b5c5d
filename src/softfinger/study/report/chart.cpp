#include "softfinger/study/report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace softfinger {
namespace {

constexpr double kLeft = 64.0;
constexpr double kRight = 12.0;
constexpr double kTop = 10.0;
constexpr double kBottom = 40.0;

constexpr std::string_view kStyle =
    "text{font:11px sans-serif;fill:#333}line,path{fill:none;stroke:#999}"
    ".all{fill:#7a9cc6;fill-opacity:.55}.front{fill:#c0392b}.mean{stroke:#1f3b63;stroke-width:2}"
    ".frontline{stroke:#c0392b;stroke-width:1.2}.bar{fill:#7a9cc6}.grid{stroke:#e4e4e4}";

double scaled(const Chart::Axis& axis, double value) {
  if (!axis.log) return (value - axis.min) / (axis.max - axis.min);
  return (std::log(value) - std::log(axis.min)) / (std::log(axis.max) - std::log(axis.min));
}

/// Round numbers, about five.
std::vector<double> ticks_of(const Chart::Axis& axis) {
  std::vector<double> ticks;
  if (axis.log) {
    for (double decade = std::pow(10.0, std::floor(std::log10(axis.min))); decade <= axis.max;
         decade *= 10.0) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double tick = decade * digit;
        if (tick >= axis.min && tick <= axis.max) ticks.push_back(tick);
      }
    }
    if (ticks.size() >= 2 && ticks.size() <= 9) return ticks;
    ticks.clear();
  }
  const double rough = (axis.max - axis.min) / 5.0;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / decade;
  const double step = decade * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
  for (double k = std::ceil(axis.min / step);
       k * step <= axis.max * (1.0 + 1e-12) && ticks.size() < 20; k += 1.0) {
    if (!axis.log || k > 0.0) ticks.push_back(k * step + 0.0);
  }
  return ticks;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result.push_back(c);
    }
  }
  return result;
}

Chart::Chart(double width, double height, Axis x, Axis y)
    : width_(width), height_(height), x_(std::move(x)), y_(std::move(y)) {
  draw_axes();
}

Chart::Axis Chart::axis(std::string label, const std::vector<double>& values, bool log) {
  Axis axis{.label = std::move(label), .log = log};
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite),
                       [](double v) { return std::isfinite(v); });
  if (finite.empty()) return axis;
  const auto [least, greatest] = std::ranges::minmax(finite);
  axis.log = log && least > 0.0;
  if (axis.log) {
    const double room = std::max(std::pow(greatest / least, 0.04), 1.02);
    axis.min = least / room;
    axis.max = greatest * room;
    return axis;
  }
  const double room =
      greatest > least ? 0.04 * (greatest - least) : std::max(0.1 * std::abs(least), 1e-6);
  axis.min = least - room;
  axis.max = greatest + room;
  return axis;
}

double Chart::x(double value) const {
  return kLeft + (width_ - kLeft - kRight) * scaled(x_, value);
}

double Chart::y(double value) const {
  return height_ - kBottom - (height_ - kTop - kBottom) * scaled(y_, value);
}

bool Chart::inside(const std::pair<double, double>& point) const {
  return point.first >= x_.min && point.first <= x_.max && point.second >= y_.min &&
         point.second <= y_.max;
}

void Chart::draw_axes() {
  const double bottom = height_ - kBottom;
  auto out = std::back_inserter(drawn_);
  for (const double tick : ticks_of(x_)) {
    fmt::format_to(out,
                   "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>",
                   x(tick), kTop, bottom);
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.4g}</text>",
                   x(tick), bottom + 14.0, tick);
  }
  if (!y_.label.empty()) {
    for (const double tick : ticks_of(y_)) {
      fmt::format_to(out,
                     "<line class=\"grid\" x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>",
                     y(tick), kLeft, width_ - kRight);
      fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.4g}</text>",
                     kLeft - 5.0, y(tick) + 4.0, tick);
    }
  }
  fmt::format_to(out, "<path d=\"M{0} {1}V{2}H{3}\"/>", kLeft, kTop, bottom, width_ - kRight);
  fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                 0.5 * (kLeft + width_ - kRight), height_ - 8.0, escaped(x_.label));
  fmt::format_to(out,
                 "<text transform=\"translate(13 {:.1f}) rotate(-90)\" "
                 "text-anchor=\"middle\">{}</text>",
                 0.5 * (kTop + bottom), escaped(y_.label));
}

void Chart::dots(const Points& points, std::string_view style) {
  for (const auto& point : points) {
    if (!inside(point)) continue;
    fmt::format_to(std::back_inserter(drawn_),
                   "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", style,
                   x(point.first), y(point.second), style == "front" ? 3.5 : 2.5);
  }
}

void Chart::line(const Points& points, std::string_view style) {
  std::string path;
  for (const auto& point : points) {
    if (!inside(point)) continue;
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? "M" : "L",
                   x(point.first), y(point.second));
  }
  if (!path.empty()) drawn_ += fmt::format("<path class=\"{}\" d=\"{}\"/>", style, path);
}

void Chart::bar(double at, double value, double low, double high) {
  auto out = std::back_inserter(drawn_);
  fmt::format_to(out,
                 "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>",
                 x(0.0), y(at) - 6.0, std::max(0.0, x(value) - x(0.0)));
  fmt::format_to(out, "<path class=\"mean\" d=\"M{0:.1f} {2:.1f}H{1:.1f}\"/>", x(low), x(high),
                 y(at));
}

void Chart::name(double at, std::string_view text) {
  fmt::format_to(std::back_inserter(drawn_), "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                 kLeft + 4.0, y(at) - 9.0, escaped(text));
}

std::string Chart::svg() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" "
      "width=\"{0}\" height=\"{1}\"><style>{2}</style>{3}</svg>",
      width_, height_, kStyle, drawn_);
}

}  // namespace softfinger
