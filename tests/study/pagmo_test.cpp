// A search by our loop, with its journal, ranks and expressions, against the same algorithm of
// pagmo on pagmo's own problem, evaluated by pagmo's own threads.
#if defined(SOFTFINGER_PAGMO)

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/batch_evaluators/thread_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/problems/zdt.hpp>
#include <pagmo/utils/hypervolume.hpp>
#include <string>
#include <utility>
#include <vector>

#include "study_place.hpp"

namespace softfinger {
namespace {

using Points = std::vector<std::vector<double>>;

/// pagmo's ZDT1, which remembers what it came to.
struct Remembered {
  [[nodiscard]] std::vector<double> fitness(const std::vector<double>& x) const {
    std::vector<double> value = zdt1.fitness(x);
    const std::scoped_lock lock(*mutex);
    points->push_back(value);
    return value;
  }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return zdt1.get_bounds();
  }
  [[nodiscard]] std::size_t get_nobj() const { return zdt1.get_nobj(); }

  pagmo::zdt zdt1{1, 3};
  std::shared_ptr<std::mutex> mutex = std::make_shared<std::mutex>();
  std::shared_ptr<Points> points = std::make_shared<Points>();
};

double hypervolume(const Points& points) { return pagmo::hypervolume(points).compute({2.0, 12.0}); }

TEST(Pagmo, ASearchComesToTheHypervolumeOfItsOwnEvaluator) {
  constexpr unsigned kSize = 24;
  constexpr unsigned kGenerations = 30;
  double other = 0.0;
  for (const unsigned seed : {1u, 2u, 77u}) {
    const Remembered zdt1;
    const pagmo::problem problem(zdt1);
    const pagmo::bfe threads{pagmo::thread_bfe()};
    pagmo::nsga2 algorithm(kGenerations, 0.95, 10.0, 1.0 / 3.0, 50.0, seed);
    algorithm.set_bfe(threads);
    static_cast<void>(algorithm.evolve(pagmo::population(problem, threads, kSize, seed)));

    StudyPlace place;
    const std::string x = "device.mount.translation_mm.";
    const std::string g = "(1 + 9 * (" + x + "1 + " + x + "2) / 2)";
    const StudyTable table = place.run_all(
        std::string(StudyPlace::kVaryTwo) + x + "2 = { min = 0, max = 1 }\n[objectives]\nf1 = { " +
        "formula = \"" + x + "0\" }\nf2 = { formula = \"" + g + " * (1 - sqrt(" + x + "0 / " + g +
        "))\" }\n[design]\nkind = \"nsga2\"\nsize = " + std::to_string(kSize) + "\ngenerations = " +
        std::to_string(kGenerations) + "\nseed = " + std::to_string(seed) + "\n");
    Points ours;
    for (const StudyRow& row : table.rows) ours.push_back(row.quantities);
    ASSERT_EQ(ours.size(), kSize * (kGenerations + 1));
    const double found = hypervolume(ours);
    EXPECT_DOUBLE_EQ(found, hypervolume(*zdt1.points)) << seed;
    EXPECT_NE(found, other) << "another seed takes another way";
    other = found;
    // Not the front alone: each of its designs, in whatever order the threads took them.
    std::ranges::sort(ours);
    std::ranges::sort(*zdt1.points);
    EXPECT_EQ(ours, *zdt1.points) << seed;
  }
}

}  // namespace
}  // namespace softfinger

#endif
