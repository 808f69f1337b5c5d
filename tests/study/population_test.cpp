// People: the same ones for the same seed, spread and correlated as asked for.
#include "softfinger/study/population.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../support/folders.hpp"
#include "softfinger/files/text_file.hpp"

namespace softfinger {
namespace {

TEST(Population, HasTheSpreadThatIsAskedFor) {
  Population population;
  population.size = 4000;
  population.modulus_correlation = 0.3;
  const std::vector<PersonFactors> people = draw_people(population);
  ASSERT_EQ(people.size(), 4000u);
  double mean = 0.0;
  double modulus = 0.0;
  for (const PersonFactors& one : people) {
    mean += one.breadth / 4000.0;
    modulus += one.modulus / 4000.0;
    EXPECT_NEAR(one.length, 1.0, 2.5 * population.length_sd + 1e-12);
  }
  double variance = 0.0;
  double both = 0.0;
  double depth_variance = 0.0;
  double stiff = 0.0;
  double log_variance = 0.0;
  for (const PersonFactors& one : people) {
    variance += std::pow(one.breadth - mean, 2) / 4000.0;
    depth_variance += std::pow(one.depth - 1.0, 2) / 4000.0;
    both += (one.breadth - mean) * (one.depth - 1.0) / 4000.0;
    const double log_modulus = std::log(one.modulus);
    stiff += (one.breadth - mean) * log_modulus / 4000.0;
    log_variance += log_modulus * log_modulus / 4000.0;
  }
  EXPECT_NEAR(mean, 1.0, 0.004);
  EXPECT_NEAR(modulus, 1.0, 0.03);
  // What lies beyond 2.5 deviations is left out.
  EXPECT_NEAR(std::sqrt(variance), 0.07, 0.006);
  EXPECT_NEAR(both / std::sqrt(variance * depth_variance), 0.7, 0.06);
  EXPECT_NEAR(stiff / std::sqrt(variance * log_variance), 0.3, 0.06);
}

TEST(Population, IsTheSameForTheSameSeed) {
  Population population;
  population.size = 8;
  EXPECT_EQ(draw_people(population), draw_people(population));
  Population other = population;
  other.seed = 2;
  EXPECT_NE(draw_people(population), draw_people(other));
  // More people are these and others.
  Population more = population;
  more.size = 16;
  const auto few = draw_people(population);
  const auto many = draw_people(more);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  population.size = 1;
  EXPECT_EQ(draw_people(population), std::vector<PersonFactors>{PersonFactors{}});
}

TEST(Population, APersonsFingerHasTheirSizeAndStiffness) {
  const std::filesystem::path file = std::filesystem::path(source_folder()) / "fingers/index.toml";
  const std::string text = read_text_file(file, 1 << 20);
  const auto nominal = FingerModel::load(file, text);
  const PersonFactors person{.length = 1.1, .breadth = 0.9, .depth = 1.05, .modulus = 1.5};
  const auto own = finger_of(nominal, person, text);
  const FingerSize size = finger_size(*nominal);
  const FingerSize theirs = finger_size(*own);
  EXPECT_NEAR(*theirs.length, 1.1 * *size.length, 1e-12);
  EXPECT_NEAR(*theirs.breadth, 0.9 * *size.breadth, 1e-12);
  EXPECT_NEAR(*theirs.depth, 1.05 * *size.depth, 1e-12);
  EXPECT_DOUBLE_EQ(own->materials[0].youngs_modulus, 1.5 * nominal->materials[0].youngs_modulus);
  EXPECT_DOUBLE_EQ(own->strain_limits.stiffness, 1.5 * nominal->strain_limits.stiffness);
  EXPECT_EQ(finger_of(nominal, PersonFactors{}, text), nominal);
}

}  // namespace
}  // namespace softfinger
