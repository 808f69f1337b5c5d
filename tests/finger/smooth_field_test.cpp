#include "softfinger/finger/smooth_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace softfinger {
namespace {

const Eigen::AlignedBox3d kBox(Vector3(-6e-3, -5e-3, -4e-3), Vector3(6e-3, 5e-3, 4e-3));

/// A box of stuff in small cubes, each a part of the mesh, or in columns of them.
struct Stuff {
  std::vector<Vector3> centres;  ///< of parts
  SmoothField field;

  explicit Stuff(const std::shared_ptr<const FieldCells>& cells, double width, int column)
      : field(cells) {
    const Vector3 size = kBox.sizes();
    const auto count = [&](int axis) { return static_cast<int>(std::lround(size[axis] / width)); };
    std::size_t part = 0;
    for (int i = 0; i < count(0); ++i) {
      for (int j = 0; j < count(1); ++j) {
        for (int k = 0; k < count(2); k += column, ++part) {
          centres.emplace_back(Vector3::Zero());
          for (int n = 0; n < column; ++n) {
            const Vector3 p = kBox.min() + width * Vector3(i + 0.5, j + 0.5, k + n + 0.5);
            centres.back() += p / column;
            field.add(part, p, width * width * width);
          }
        }
      }
    }
    field.finish();
  }
};

double sum(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(SmoothField, KeepsWhatThereIsAndWhatIsEven) {
  const auto cells = std::make_shared<FieldCells>(kBox);
  Stuff stuff(cells, 1e-3, 2);
  const double volume = kBox.sizes().prod();
  EXPECT_NEAR(sum(stuff.field.amounts()), volume, 1e-9 * volume);
  std::vector<double> field(cells->size());
  stuff.field.spread(std::vector<double>(stuff.centres.size(), 3.0), field);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::vector<double> values(stuff.centres.size());
  int filled = 0;
  for (std::size_t c = 0; c < field.size(); ++c) {
    if (stuff.field.amounts()[c] == 0.0) continue;
    EXPECT_NEAR(field[c], 3.0, 1e-9);
    ++filled;
  }
  EXPECT_GT(filled, 1000);
  for (double& value : values) value = any(random);
  stuff.field.spread(values, field);
  double borne = 0.0;
  for (std::size_t c = 0; c < field.size(); ++c) borne += field[c] * stuff.field.amounts()[c];
  EXPECT_NEAR(borne, sum(values) * 2e-9, 1e-9 * borne);
}

TEST(SmoothField, BlursByItsStandardDeviation) {
  const auto cells = std::make_shared<FieldCells>(kBox);
  SmoothField field(cells);
  // On a grid point of the cells, so that nothing else spreads it.
  const Vector3 p = kBox.min() + 5.0 * FieldCells::kWidth * Vector3::Ones();
  field.add(0, p, 1.0);
  field.finish();
  double variance = 0.0;
  double at_most = 0.0;
  for (std::size_t c = 0; c < cells->size(); ++c) at_most = std::max(at_most, field.amounts()[c]);
  const auto x_of = [&](std::size_t c) {
    // The first axis is the fastest; p's own cell has the most.
    std::size_t own = 0;
    while (field.amounts()[own] < at_most) ++own;
    return FieldCells::kWidth * (static_cast<double>(c) - static_cast<double>(own));
  };
  double line = 0.0;
  for (std::size_t c = 0; c < cells->size(); ++c) {
    if (field.amounts()[c] == 0.0 || std::abs(x_of(c)) > 3e-3) continue;
    line += field.amounts()[c];
    variance += field.amounts()[c] * x_of(c) * x_of(c);
  }
  EXPECT_GT(line, 0.1);
  EXPECT_NEAR(std::sqrt(variance / line), FieldCells::kBlur, 1e-9);
}

// A bump as parts of two meshes know it.
TEST(SmoothField, HardlyKnowsTheMesh) {
  const auto cells = std::make_shared<FieldCells>(kBox);
  Stuff fine(cells, 0.5e-3, 1);
  Stuff coarse(cells, 1e-3, 2);
  const auto spread = [&](Stuff& stuff) {
    std::vector<double> values;
    for (const Vector3& p : stuff.centres) values.push_back(std::exp(-p.squaredNorm() / 9e-6));
    std::vector<double> field(cells->size());
    stuff.field.spread(values, field);
    return field;
  };
  const std::vector<double> a = spread(fine);
  const std::vector<double> b = spread(coarse);
  double difference = 0.0, size = 0.0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    difference += fine.field.amounts()[c] * (b[c] - a[c]) * (b[c] - a[c]);
    size += fine.field.amounts()[c] * a[c] * a[c];
  }
  EXPECT_GT(size, 0.0);
  EXPECT_LT(std::sqrt(difference / size), 0.06);
}

}  // namespace
}  // namespace softfinger
