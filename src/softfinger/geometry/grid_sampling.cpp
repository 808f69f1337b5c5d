#include "softfinger/geometry/grid_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

using Place = std::array<int, 3>;
constexpr int kCells = GridLevel::kCells;
constexpr int kRow = GridLevel::kRow;
/// Samples along an axis that a block's coefficients need: two before its own, three behind.
constexpr int kSampleRow = kRow + 2;
constexpr int kOwnSamples = kCells * kCells * kCells;

/// About 640 MB of coefficients.
constexpr std::size_t kMostBlocks = 120'000;
/// As many times too many as a coarse level lets expect, which is more than there will be where the
/// surface is thin, are refused before they are sampled.
constexpr double kFarTooMany = 30.0;
/// The last level has every block, so it is the first with at most this many.
constexpr double kLastLevelBlocks = 100;
/// A block belongs to the band where a cube of this many cells may.
constexpr int kProbe = 2;
/// Spacings from the surface beyond which a sample may come from the next level: none that matters
/// within the band is that far.
constexpr double kExact = 5.0;

/// Spacings by which the distance of the next level may be off without a second search.
constexpr double kSlack = 0.02;

/// Samples one level; those coarser than it are complete.
class LevelSampler {
 public:
  LevelSampler(const TriangleTree& tree, SignedDistanceGrid::Content& content, std::size_t l)
      : tree_(tree), content_(content), l_(l), level_(content.levels[l]) {}

  /// Chooses among the candidates the places that the band about the surface reaches.
  [[nodiscard]] std::vector<Place> in_band(const std::vector<Place>& candidates,
                                           const Progress& progress) const {
    // A spacing more: what decides are the distances of the next level.
    const double reach =
        (SignedDistanceGrid::kBandEnd + 1.0 + 0.5 * kProbe * std::numbers::sqrt3) * level_.spacing;
    std::vector<char> chosen(candidates.size());
    parallel_for(
        candidates.size(),
        [&](std::size_t i) {
          constexpr int kProbes = kCells / kProbe;
          for (int n = 0; n < kProbes * kProbes * kProbes && chosen[i] == 0; ++n) {
            const Vector3 centre =
                (kCells * vector(candidates[i]) +
                 kProbe * (vector({n % kProbes, n / kProbes % kProbes, n / (kProbes * kProbes)}) +
                           Vector3::Constant(0.5))) *
                level_.spacing;
            if (std::abs(coarser(centre)) <= reach) chosen[i] = 1;
          }
        },
        progress);
    std::vector<Place> places;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (chosen[i] != 0) places.push_back(candidates[i]);
    }
    return places;
  }

  void sample(const std::vector<Place>& places, const Progress& progress) {
    level_.index.assign(level_.places(), -1);
    for (std::size_t i = 0; i < places.size(); ++i) {
      level_.index[place_of(places[i])] = static_cast<std::int32_t>(i);
    }
    samples_.resize(places.size() * kOwnSamples);
    level_.coefficients.resize(places.size() * GridLevel::kBlockSize);
    const Progress first = progress ? Progress([&](double f) { progress(0.8 * f); }) : Progress();
    const Progress then =
        progress ? Progress([&](double f) { progress(0.8 + 0.2 * f); }) : Progress();
    parallel_for(
        places.size(), [&](std::size_t i) { sample_block(places[i], i); }, first);
    parallel_for(
        places.size(), [&](std::size_t i) { filter_block(places[i], i); }, then);
  }

 private:
  [[nodiscard]] std::size_t place_of(const Place& at) const {
    return level_.place(static_cast<std::size_t>(at[0]), static_cast<std::size_t>(at[1]),
                        static_cast<std::size_t>(at[2]));
  }
  static Vector3 vector(const Place& at) { return {1.0 * at[0], 1.0 * at[1], 1.0 * at[2]}; }

  /// Distance by the levels coarser than this one, at p from the domain's corner.
  [[nodiscard]] double coarser(const Vector3& p) const {
    SignedDistance result;
    for (std::size_t l = l_ + 1; l < content_.levels.size(); ++l) {
      if (interpolate<false>(content_.levels[l], kernels_, p, result)) break;
    }
    return result.distance;
  }

  /// Distance at grid point `at` of this level; exact where it matters.
  [[nodiscard]] float distance(const Place& at, int& near) const {
    const Vector3 p = level_.spacing * vector(at);
    const Vector3 p_O = content_.domain.min() + p;
    TriangleTree::Closest closest{.distance = std::numeric_limits<double>::infinity()};
    if (l_ + 1 < content_.levels.size() &&
        Eigen::AlignedBox3d(Vector3::Zero(), content_.domain.sizes()).contains(p)) {
      const double rough = coarser(p);
      if (std::abs(rough) > kExact * level_.spacing) return static_cast<float>(rough);
      // Right nearly everywhere, and the narrower the search the shorter.
      closest = tree_.closest(p_O, near, std::abs(rough) + kSlack * level_.spacing);
    }
    if (!std::isfinite(closest.distance)) closest = tree_.closest(p_O, near);
    near = closest.triangle;
    return static_cast<float>(closest.distance);
  }

  void sample_block(const Place& at, std::size_t number) {
    float* samples = samples_.data() + number * kOwnSamples;
    int near = -1;
    for (int n = 0; n < kOwnSamples; ++n) {
      // To and fro, so that each point is beside the one before.
      const int k = n / (kCells * kCells);
      const int j = k % 2 == 0 ? n / kCells % kCells : kCells - 1 - n / kCells % kCells;
      const int i = (j + k) % 2 == 0 ? n % kCells : kCells - 1 - n % kCells;
      samples[(k * kCells + j) * kCells + i] =
          distance({at[0] * kCells + i, at[1] * kCells + j, at[2] * kCells + k}, near);
    }
  }

  /// Coefficients from samples, which reproduces cubic polynomials: c = f - f'' / 6 with second
  /// differences along each axis (the quasi-interpolant of de Boor, A Practical Guide to Splines,
  /// chapter XII).
  void filter_block(const Place& at, std::size_t number) {
    std::vector<float> f(kSampleRow * kSampleRow * kSampleRow);
    int near = -1;
    std::size_t n = 0;
    for (int k = -2; k < kSampleRow - 2; ++k) {
      for (int j = -2; j < kSampleRow - 2; ++j) {
        for (int i = -2; i < kSampleRow - 2; ++i) {
          f[n++] = sampled({at[0] * kCells + i, at[1] * kCells + j, at[2] * kCells + k}, near);
        }
      }
    }
    // Ends of rows become nonsense, which no coefficient of the block takes in.
    std::vector<float> g(f.size());
    for (std::size_t stride = 1; stride <= kSampleRow * kSampleRow; stride *= kSampleRow) {
      for (std::size_t m = stride; m + stride < f.size(); ++m) {
        g[m] = (8.0F * f[m] - f[m - stride] - f[m + stride]) / 6.0F;
      }
      std::swap(f, g);
    }
    float* coefficients = level_.coefficients.data() + number * GridLevel::kBlockSize;
    for (int k = 1; k <= kRow; ++k) {
      for (int j = 1; j <= kRow; ++j) {
        for (int i = 1; i <= kRow; ++i) {
          *coefficients++ = f[static_cast<std::size_t>((k * kSampleRow + j) * kSampleRow + i)];
        }
      }
    }
  }

  /// The sample at a grid point: of the block that has it, else taken anew.
  [[nodiscard]] float sampled(const Place& at, int& near) const {
    Place block;
    Place own;
    for (std::size_t k = 0; k < 3; ++k) {
      if (at[k] < 0 || at[k] >= level_.blocks[k] * kCells) return distance(at, near);
      block[k] = at[k] / kCells;
      own[k] = at[k] % kCells;
    }
    const std::int32_t number = level_.index[place_of(block)];
    if (number < 0) return distance(at, near);
    return samples_[static_cast<std::size_t>(number) * kOwnSamples +
                    static_cast<std::size_t>((own[2] * kCells + own[1]) * kCells + own[0])];
  }

  const TriangleTree& tree_;
  SignedDistanceGrid::Content& content_;
  std::size_t l_;
  GridLevel& level_;
  /// Whoever samples, the grid is the same.
  const SplineKernels& kernels_ = spline_kernels(InstructionSet::kBaseline);
  std::vector<float> samples_;
};

std::vector<Place> all_places(const Place& blocks) {
  std::vector<Place> places;
  for (int z = 0; z < blocks[2]; ++z) {
    for (int y = 0; y < blocks[1]; ++y) {
      for (int x = 0; x < blocks[0]; ++x) places.push_back({x, y, z});
    }
  }
  return places;
}

/// The places of a level that halve the blocks of the one before, of twice its spacing.
std::vector<Place> children(const std::vector<Place>& parents, const Place& blocks) {
  std::vector<Place> places;
  places.reserve(8 * parents.size());
  for (const Place& parent : parents) {
    for (int n = 0; n < 8; ++n) {
      const Place at{2 * parent[0] + n % 2, 2 * parent[1] + n / 2 % 2, 2 * parent[2] + n / 4};
      if (at[0] < blocks[0] && at[1] < blocks[1] && at[2] < blocks[2]) places.push_back(at);
    }
  }
  return places;
}

/// Levels without blocks, from `spacing` on.
std::vector<GridLevel> empty_levels(const Vector3& size, double spacing) {
  std::vector<GridLevel> levels;
  double places = 0.0;
  do {
    GridLevel& level = levels.emplace_back();
    level.spacing = spacing;
    level.per_spacing = 1.0 / spacing;
    places = 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double blocks = std::ceil(size[static_cast<int>(k)] / (spacing * kCells));
      level.blocks[k] = static_cast<int>(std::min(blocks, 1e6));
      places *= blocks;
    }
    spacing *= 2.0;
  } while (places > kLastLevelBlocks);
  return levels;
}

}  // namespace

SignedDistanceGrid::Content sample_distance(const ClosedSurface& surface, const TriangleTree& tree,
                                            double spacing, double margin,
                                            const std::string& source, const Progress& progress) {
  SignedDistanceGrid::Content content;
  for (const Vector3& p : surface.mesh.positions) content.bounds.extend(p);
  content.triangle_count = surface.mesh.triangles.size();
  content.domain = content.bounds;
  content.domain.min().array() -= margin;
  content.domain.max().array() += margin;
  content.levels = empty_levels(content.domain.sizes(), spacing);
  std::vector<Place> places = all_places(content.levels.back().blocks);
  for (std::size_t l = content.levels.size(); l-- > 0;) {
    GridLevel& level = content.levels[l];
    LevelSampler sampler(tree, content, l);
    // Each level has about four times the samples of the next.
    const double end = std::pow(0.25, static_cast<double>(l));
    const Progress begun = [&](double) { progress(0.25 * end); };
    const Progress part = [&](double f) { progress(end * (0.25 + 0.75 * f)); };
    if (l + 1 < content.levels.size()) {
      places = sampler.in_band(children(places, level.blocks), progress ? begun : Progress());
    }
    // The next level would have about four times as many.
    const double finest =
        static_cast<double>(places.size()) * std::pow(4.0, static_cast<double>(l));
    if (places.size() > kMostBlocks || static_cast<double>(level.places()) > 2e8 ||
        finest > kFarTooMany * static_cast<double>(kMostBlocks)) {
      throw InputError(fmt::format(
          "{}: too large for a distance grid of {:.3g} mm; about {:.2g} mm or more would do",
          source, spacing / mm,
          1.2 * std::sqrt(finest / static_cast<double>(kMostBlocks)) * spacing / mm));
    }
    sampler.sample(places, progress ? part : Progress());
  }
  return content;
}

}  // namespace softfinger
