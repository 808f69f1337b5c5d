#include "softfinger/finger/smooth_field.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

/// Quarters of two neighbours and half of itself, so often: each adds half a squared cell to the
/// variance.
constexpr int kPasses = 2;
static_assert(FieldCells::kBlur * FieldCells::kBlur * 2.0 ==
              kPasses * FieldCells::kWidth * FieldCells::kWidth);

}  // namespace

FieldCells::FieldCells(const Eigen::AlignedBox3d& box) {
  // Blurring reaches so many cells beyond the two that a place is between.
  const double margin = (kPasses + 1) * kWidth;
  origin_ = box.min() - Vector3::Constant(margin);
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    counts_[k] = static_cast<int>(std::ceil((box.sizes()[axis] + 2.0 * margin) / kWidth)) + 1;
    strides_[k] = stride;
    stride *= static_cast<std::size_t>(counts_[k]);
  }
}

std::array<FieldCells::Share, 8> FieldCells::shares(const Vector3& p) const {
  std::array<std::size_t, 3> low;
  Vector3 way;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double at = std::clamp((p[axis] - origin_[axis]) / kWidth, 0.0, counts_[k] - 1.001);
    low[k] = static_cast<std::size_t>(at);
    way[axis] = at - static_cast<double>(low[k]);
  }
  std::array<Share, 8> shares;
  for (std::size_t n = 0; n < 8; ++n) {
    shares[n] = {0, 1.0};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t up = (n >> k) & 1U;
      const double part = way[static_cast<Eigen::Index>(k)];
      shares[n].cell += (low[k] + up) * strides_[k];
      shares[n].part *= up == 1 ? part : 1.0 - part;
    }
  }
  return shares;
}

void FieldCells::blur_along(int axis, std::span<const double> from, std::span<double> to) const {
  const std::size_t stride = strides_[static_cast<std::size_t>(axis)];
  const auto count = static_cast<std::size_t>(counts_[static_cast<std::size_t>(axis)]);
  const std::size_t slab = stride * count;
  for (std::size_t start = 0; start < from.size(); start += slab) {
    // What would come from outside is lost; the margin is there for that.
    for (std::size_t i = start; i < start + slab; ++i) {
      const double before = i >= start + stride ? from[i - stride] : 0.0;
      const double behind = i + stride < start + slab ? from[i + stride] : 0.0;
      to[i] = 0.5 * from[i] + 0.25 * (before + behind);
    }
  }
}

void FieldCells::blur(std::span<double> values, std::span<double> scratch) const {
  static_assert(kPasses % 2 == 0);
  for (int axis = 0; axis < 3; ++axis) {
    for (int pass = 0; pass < kPasses; pass += 2) {
      blur_along(axis, values, scratch);
      blur_along(axis, scratch, values);
    }
  }
}

void SmoothField::add(std::size_t part, const Vector3& p, double amount) {
  for (const auto& [cell, share] : cells_->shares(p)) {
    entries_.push_back({part, cell, amount * share});
  }
}

void SmoothField::finish() {
  std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.part != b.part ? a.part < b.part : a.cell < b.cell;
  });
  std::size_t kept = 0;
  for (const Entry& entry : entries_) {
    if (kept > 0 && entries_[kept - 1].part == entry.part &&
        entries_[kept - 1].cell == entry.cell) {
      entries_[kept - 1].amount += entry.amount;
    } else {
      entries_[kept++] = entry;
    }
  }
  entries_.resize(kept);
  entries_.shrink_to_fit();
  amounts_.assign(cells_->size(), 0.0);
  scratch_.resize(cells_->size());
  for (const Entry& entry : entries_) amounts_[entry.cell] += entry.amount;
  cells_->blur(amounts_, scratch_);
}

void SmoothField::spread(std::span<const double> values, std::span<double> field) {
  std::fill(field.begin(), field.end(), 0.0);
  for (const Entry& entry : entries_) field[entry.cell] += entry.amount * values[entry.part];
  cells_->blur(field, scratch_);
  for (std::size_t c = 0; c < field.size(); ++c) {
    if (amounts_[c] > 0.0) field[c] /= amounts_[c];
  }
}

}  // namespace softfinger
