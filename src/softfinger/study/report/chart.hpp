#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softfinger {

/// `text` as it stands between tags.
[[nodiscard]] std::string escaped(std::string_view text);

/// A plot of one number over another, as an SVG element of its own style.
class Chart {
 public:
  struct Axis {
    std::string label;
    double min = 0.0, max = 1.0;
    bool log = false;
  };
  using Points = std::vector<std::pair<double, double>>;

  Chart(double width, double height, Axis x, Axis y);

  /// Dots of a class: "all", "front" or "mean". Those outside the axes are left out.
  void dots(const Points& points, std::string_view style);
  void line(const Points& points, std::string_view style);
  /// A bar from 0 along x, at y, with an interval.
  void bar(double y, double value, double low, double high);
  /// At the left of a bar.
  void name(double y, std::string_view text);
  [[nodiscard]] std::string svg() const;

  /// From the least to the greatest number with room around; of one number, some room about it.
  [[nodiscard]] static Axis axis(std::string label, const std::vector<double>& values,
                                 bool log = false);

 private:
  [[nodiscard]] double x(double value) const;
  [[nodiscard]] double y(double value) const;
  [[nodiscard]] bool inside(const std::pair<double, double>& point) const;
  void draw_axes();

  double width_, height_;
  Axis x_, y_;
  std::string drawn_;
};

}  // namespace softfinger
