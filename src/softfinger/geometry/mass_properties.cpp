#include "softfinger/geometry/mass_properties.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace softfinger {
namespace {

constexpr double kPi = std::numbers::pi;

/// Area and integrals of x^2 and y^2 of a cross-section at one height.
struct Section {
  double area = 0.0, xx = 0.0, yy = 0.0;
};

/// Integral of x^2 over the rectangle of half sizes (a, b) swept by a disc of this radius.
double second_moment(double a, double b, double radius) {
  const double r2 = radius * radius;
  const double outer = a + radius;
  const double middle = 4.0 / 3.0 * a * a * a * (b + radius);
  const double sides =
      4.0 * (b * (outer * outer * outer - a * a * a) / 3.0 + a * a * kPi * r2 / 4.0 +
             2.0 / 3.0 * a * r2 * radius + kPi * r2 * r2 / 16.0);
  return middle + sides;
}

Section rounded_rectangle(double a, double b, double radius) {
  return {4.0 * a * b + 4.0 * (a + b) * radius + kPi * radius * radius, second_moment(a, b, radius),
          second_moment(b, a, radius)};
}

Section disc(double radius) {
  const double r2 = radius * radius;
  return {kPi * r2, kPi / 4.0 * r2 * r2, kPi / 4.0 * r2 * r2};
}

/// Of a solid that is even in x, y and z: the same section up to |z| = straight, and above it that
/// of each height edge sin(phi), which section(edge cos(phi)) gives.
template <typename SectionAt>
MassProperties of_sections(double straight, double edge, const SectionAt& section) {
  MassProperties sum;
  const auto add = [&](const Section& s, double height_weight, double zz_weight) {
    sum.volume += height_weight * s.area;
    sum.second_moment_O.diagonal() +=
        Vector3(height_weight * s.xx, height_weight * s.yy, zz_weight * s.area);
  };
  add(section(edge), 2.0 * straight, 2.0 / 3.0 * straight * straight * straight);
  // Trigonometric polynomials of low degree in phi: Gauss and Legendre's rule is exact to rounding.
  constexpr std::array<std::pair<double, double>, 8> kGauss{{
      {0.0950125098376374, 0.1894506104550685},
      {0.2816035507792589, 0.1826034150449236},
      {0.4580167776572274, 0.1691565193950025},
      {0.6178762444026438, 0.1495959888165767},
      {0.7554044083550030, 0.1246289712555339},
      {0.8656312023878318, 0.0951585116824928},
      {0.9445750230732326, 0.0622535239386479},
      {0.9894009349916499, 0.0271524594117541},
  }};
  for (const auto& [node, weight] : kGauss) {
    for (const double x : {-node, node}) {
      const double phi = kPi / 4.0 * (1.0 + x);
      const double z = straight + edge * std::sin(phi);
      // Both ends.
      const double w = 2.0 * weight * kPi / 4.0 * edge * std::cos(phi);
      add(section(edge * std::cos(phi)), w, w * z * z);
    }
  }
  return sum;
}

/// By discs across the axis.
MassProperties of_capsule(const TaperedCapsule& capsule) {
  constexpr int kDiscs = 2000;
  const double lean = (capsule.back - capsule.front) / (2.0 * capsule.half_length);
  const double across = std::sqrt(1.0 - lean * lean);
  // The balls meet the cone beside their middles.
  const double cone_from = -capsule.half_length + lean * capsule.back;
  const double cone_to = capsule.half_length + lean * capsule.front;
  const double from = -capsule.half_length - capsule.back;
  const double width = (capsule.half_length + capsule.front - from) / kDiscs;
  MassProperties sum;
  double first = 0.0;
  double second = 0.0;
  for (int k = 0; k < kDiscs; ++k) {
    const double x = from + (k + 0.5) * width;
    double r2 = 0.0;
    if (x < cone_from) {
      r2 = capsule.back * capsule.back - (x + capsule.half_length) * (x + capsule.half_length);
    } else if (x > cone_to) {
      r2 = capsule.front * capsule.front - (x - capsule.half_length) * (x - capsule.half_length);
    } else {
      const double r = (capsule.back - lean * (x + capsule.half_length)) / across;
      r2 = r * r;
    }
    const Section section = disc(std::sqrt(std::max(0.0, r2)));
    sum.volume += width * section.area;
    first += width * section.area * x;
    second += width * section.area * x * x;
    sum.second_moment_O(1, 1) += width * section.xx;
    sum.second_moment_O(2, 2) += width * section.yy;
  }
  sum.centre_O.x() = first / sum.volume;
  sum.second_moment_O(0, 0) = second - first * first / sum.volume;
  return sum;
}

/// By cells that the surface cuts in proportion to its distance from their middle.
MassProperties of_distance(const Shape& shape) {
  constexpr int kMomentCells = 96;  // along the longest side
  const Eigen::AlignedBox3d box = bounds(shape);
  const double cell = box.sizes().maxCoeff() / kMomentCells;
  if (!(cell > 0.0) || !std::isfinite(cell)) return {};
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
  double sum = 0.0;
  const Eigen::Array3i count = (box.sizes() / cell).array().ceil().cast<int>() + 1;
  const Vector3 middle = box.center();
  for (int i = 0; i < count.x(); ++i) {
    for (int j = 0; j < count.y(); ++j) {
      for (int k = 0; k < count.z(); ++k) {
        const Vector3 x =
            cell * (Eigen::Array3d(i, j, k) - 0.5 * (count.cast<double>() - 1.0)).matrix();
        const double depth = -distance_and_gradient(shape, middle + x).distance / cell;
        const double part = std::clamp(0.5 + depth, 0.0, 1.0);
        sum += part;
        first += part * x;
        second += part * x * x.transpose();
      }
    }
  }
  if (!(sum > 0.0)) return {};
  MassProperties even;
  const Vector3 centre = first / sum;
  const double volume = cell * cell * cell;
  even.volume = sum * volume;
  even.centre_O = middle + centre;
  even.second_moment_O = volume * (second - sum * centre * centre.transpose());
  even.second_moment_O.diagonal().array() += even.volume * cell * cell / 12.0;
  return even;
}

struct Moments {
  std::optional<MassProperties> operator()(const HalfSpace& /*shape*/) const { return {}; }
  std::optional<MassProperties> operator()(const Ball& ball) const {
    return of_sections(0.0, ball.radius, [](double radius) { return disc(radius); });
  }
  std::optional<MassProperties> operator()(const RoundedBox& box) const {
    const Vector3 inner = box.half_size.array() - box.edge_radius;
    return of_sections(inner.z(), box.edge_radius, [&](double radius) {
      return rounded_rectangle(inner.x(), inner.y(), radius);
    });
  }
  std::optional<MassProperties> operator()(const RoundedCylinder& cylinder) const {
    const double inner = cylinder.radius - cylinder.edge_radius;
    return of_sections(cylinder.half_length - cylinder.edge_radius, cylinder.edge_radius,
                       [&](double radius) { return disc(inner + radius); });
  }
  std::optional<MassProperties> operator()(const TaperedCapsule& capsule) const {
    return of_capsule(capsule);
  }
  std::optional<MassProperties> operator()(const MeshShape& mesh) const {
    const MassProperties even = of_distance(mesh);
    return even.volume > 0.0 ? std::optional(even) : std::nullopt;
  }
};

}  // namespace

std::optional<MassProperties> mass_properties(const Shape& shape) {
  return std::visit(Moments{}, shape);
}

}  // namespace softfinger
