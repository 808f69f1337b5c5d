#include "softfinger/geometry/signed_distance_grid.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

/// 1 up to `start`, 0 from `end`, twice differentiable between; with its derivatives by x.
struct Blend {
  double weight = 1.0, slope = 0.0, bend = 0.0;
};

Blend blend(double x, double start, double end) {
  if (x <= start) return {};
  const double width = end - start;
  const double s = std::min(1.0, (x - start) / width);
  return {.weight = 1.0 - s * s * s * (10.0 + s * (6.0 * s - 15.0)),
          .slope = -30.0 * s * s * (1.0 - s) * (1.0 - s) / width,
          .bend = -60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (width * width)};
}

}  // namespace

SignedDistanceGrid::SignedDistanceGrid(Content content, std::filesystem::path source,
                                       std::uint64_t source_hash)
    : content_(std::move(content)),
      source_(std::move(source)),
      source_hash_(source_hash),
      kernels_(spline_kernels(active_instruction_set())) {}

std::size_t SignedDistanceGrid::memory() const {
  std::size_t bytes = 0;
  for (const GridLevel& level : content_.levels) {
    bytes += level.coefficients.size() * sizeof(float) + level.index.size() * sizeof(std::int32_t);
  }
  return bytes;
}

template <bool kWithHessian>
void SignedDistanceGrid::from_level(std::size_t l, const Vector3& p_O,
                                    SignedDistance& finer) const {
  const bool last = l + 1 == content_.levels.size();
  if (!interpolate<kWithHessian>(content_.levels[l], kernels_, p_O - content_.domain.min(),
                                 finer)) {
    if (!last) from_level<kWithHessian>(l + 1, p_O, finer);
    return;
  }
  if (last) return;
  // By the distance as this level has it: at the border of its blocks nothing of it is left.
  const double h = content_.levels[l].spacing;
  const Blend b = blend(std::abs(finer.distance), kBandStart * h, kBandEnd * h);
  if (b.weight == 1.0) return;
  SignedDistance coarser;
  from_level<kWithHessian>(l + 1, p_O, coarser);
  const double difference = finer.distance - coarser.distance;
  const double slope = finer.distance < 0.0 ? -b.slope : b.slope;
  const Vector3 apart = finer.gradient - coarser.gradient;
  if constexpr (kWithHessian) {
    const Matrix3 mixed = slope * finer.gradient * apart.transpose();
    finer.hessian = coarser.hessian + b.weight * (finer.hessian - coarser.hessian) + mixed +
                    mixed.transpose() + slope * difference * finer.hessian +
                    b.bend * difference * finer.gradient * finer.gradient.transpose();
  }
  finer.gradient = coarser.gradient + b.weight * apart + slope * difference * finer.gradient;
  finer.distance = coarser.distance + b.weight * difference;
}

template <bool kWithHessian>
SignedDistance SignedDistanceGrid::evaluate(const Vector3& p_O) const {
  const Vector3 nearest = p_O.cwiseMax(content_.domain.min()).cwiseMin(content_.domain.max());
  const Vector3 beyond = p_O - nearest;
  SignedDistance at;
  from_level<kWithHessian>(0, nearest, at);
  if (beyond.isZero(0.0)) return at;
  Vector3 along = at.gradient;
  Matrix3 curvature = at.hessian;
  for (int k = 0; k < 3; ++k) {
    if (beyond[k] == 0.0) continue;
    along[k] = 0.0;
    curvature.row(k).setZero();
    curvature.col(k).setZero();
  }
  SignedDistance result;
  result.distance = std::sqrt(at.distance * at.distance + beyond.squaredNorm());
  result.gradient = (at.distance * along + beyond) / result.distance;
  if constexpr (kWithHessian) {
    const Vector3 outward = beyond.array().abs().sign();
    result.hessian =
        (along * along.transpose() + at.distance * curvature + Matrix3(outward.asDiagonal()) -
         result.gradient * result.gradient.transpose()) /
        result.distance;
  }
  return result;
}

SignedDistance SignedDistanceGrid::signed_distance(const Vector3& p_O) const {
  return evaluate<true>(p_O);
}

SignedDistance SignedDistanceGrid::distance_and_gradient(const Vector3& p_O) const {
  return evaluate<false>(p_O);
}

}  // namespace softfinger
