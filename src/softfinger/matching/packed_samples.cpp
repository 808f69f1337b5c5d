#include "softfinger/matching/packed_samples.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace softfinger {

PackedSamples::PackedSamples(int capacity) {
  for (auto* array : {&x_, &y_, &z_, &weight_, &margin_}) {
    array->resize(static_cast<std::size_t>(capacity));
  }
}

SurfaceSamples PackedSamples::pack(const ContactPoints& points, const MatchingOptions& options,
                                   double separation_tolerance) {
  const std::size_t count = std::min(points.points_F.size(), x_.size());
  const double eps = options.separation_tolerance.value_or(separation_tolerance);
  double per_area = 0.0;
  if (options.weights == MatchingWeights::kArea) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += points.areas[i];
    per_area = sum > 0.0 ? static_cast<double>(count) / sum : 0.0;
  }
  std::size_t packed = 0;
  int contacts = 0;
  for (const bool touching : {true, false}) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((points.in_contact[i] != 0) != touching) continue;
      x_[packed] = points.points_F[i].x();
      y_[packed] = points.points_F[i].y();
      z_[packed] = points.points_F[i].z();
      weight_[packed] =
          (options.weights == MatchingWeights::kArea ? points.areas[i] * per_area : 1.0) *
          (points.shares.empty() ? 1.0 : points.shares[i]);
      margin_[packed] = options.separation == Separation::kScene && !points.gaps.empty()
                            ? std::max(0.0, std::min(eps, points.gaps[i]))
                            : eps;
      ++packed;
    }
    if (touching) contacts = static_cast<int>(packed);
  }
  const auto view = [&](const std::vector<double>& array) {
    return std::span<const double>(array.data(), packed);
  };
  return {view(x_), view(y_), view(z_), view(weight_), view(margin_), contacts};
}

}  // namespace softfinger
