#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Cells of a grid over a box, a millimetre wide: places that no mesh knows.
class FieldCells {
 public:
  static constexpr double kWidth = 1e-3;  ///< m

  explicit FieldCells(const Eigen::AlignedBox3d& box);

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
           static_cast<std::size_t>(counts_[2]);
  }
  struct Share {
    std::size_t cell;
    double part;  ///< 0 to 1
  };
  /// The eight cells whose centres are around p, by how near each is; they sum to 1.
  [[nodiscard]] std::array<Share, 8> shares(const Vector3& p) const;
  /// Replaces each cell's value by a mean over its surroundings, whose standard deviation is
  /// kBlur; `scratch` has the size of `values`.
  void blur(std::span<double> values, std::span<double> scratch) const;
  static constexpr double kBlur = 1e-3;  ///< along each axis, m

 private:
  void blur_along(int axis, std::span<const double> from, std::span<double> to) const;

  Vector3 origin_;  ///< centre of the first cell
  std::array<int, 3> counts_{};
  std::array<std::size_t, 3> strides_{};
};

/// What parts of a finger's mesh (samples of its skin, elements of its tissue) bear, as a field
/// over cells that hardly depends on how fine the mesh is: the mean of what is in each cell, by its
/// amount, both blurred. Allocates only while it is built.
class SmoothField {
 public:
  explicit SmoothField(std::shared_ptr<const FieldCells> cells) : cells_(std::move(cells)) {}

  /// `amount` (m^2 or m^3) of part `part` is at p.
  void add(std::size_t part, const Vector3& p, double amount);
  /// All is added.
  void finish();

  /// Blurred amount in each cell.
  [[nodiscard]] std::span<const double> amounts() const { return amounts_; }
  /// The field of one value a part; 0 in cells that nothing is near.
  void spread(std::span<const double> values, std::span<double> field);

 private:
  struct Entry {
    std::size_t part, cell;
    double amount;
  };
  std::shared_ptr<const FieldCells> cells_;
  std::vector<Entry> entries_;
  std::vector<double> amounts_, scratch_;
};

}  // namespace softfinger
