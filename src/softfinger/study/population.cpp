#include "softfinger/study/population.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/files/config_file.hpp"
#include "softfinger/study/random.hpp"

namespace softfinger {
namespace {

constexpr double kMostDeviations = 2.5;
constexpr int kMostPeople = 100000;

double percent(const ConfigTable& table, const char* key, double most, double fallback) {
  return 0.01 * table.number(key, Range::between(0.0, most), 100.0 * fallback);
}

Eigen::Matrix4d correlation_of(const Population& population) {
  Eigen::Matrix4d correlation = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < i; ++k) {
      correlation(i, k) = correlation(k, i) =
          i == 3 ? population.modulus_correlation : population.size_correlation;
    }
  }
  return correlation;
}

/// Two of a normal distribution, by Box and Muller (1958, Ann Math Stat 29:610).
Eigen::Vector2d normal_pair(UnitRandom& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.next()));
  const double angle = 2.0 * std::numbers::pi * random.next();
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

Population read_population(const ConfigTable& table) {
  Population population;
  population.size = table.integer("size", 1, kMostPeople);
  population.seed = static_cast<std::uint32_t>(table.integer("seed", 0, 2147483647, 1));
  population.length_sd = percent(table, "length_sd_percent", 30.0, population.length_sd);
  population.breadth_sd = percent(table, "breadth_sd_percent", 30.0, population.breadth_sd);
  population.depth_sd = percent(table, "depth_sd_percent", 30.0, population.depth_sd);
  population.modulus_sd = percent(table, "modulus_sd_percent", 100.0, population.modulus_sd);
  population.size_correlation =
      table.number("size_correlation", Range::between(0.0, 0.99), population.size_correlation);
  population.modulus_correlation = table.number("modulus_correlation", Range::between(-0.99, 0.99),
                                                population.modulus_correlation);
  if (Eigen::LLT<Eigen::Matrix4d>(correlation_of(population)).info() != Eigen::Success) {
    table.fail("modulus_correlation", "is more than the sizes' own correlation allows");
  }
  population.fitted = table.choice("model", {"fitted", "nominal"}, "fitted") == "fitted";
  return population;
}

std::vector<PersonFactors> draw_people(const Population& population) {
  if (population.size == 1) return {PersonFactors{}};
  const Eigen::Matrix4d root = Eigen::LLT<Eigen::Matrix4d>(correlation_of(population)).matrixL();
  UnitRandom random(population.seed);
  // Of a lognormal distribution with mean 1 and this deviation.
  const double spread = std::sqrt(std::log1p(population.modulus_sd * population.modulus_sd));
  std::vector<PersonFactors> people;
  while (people.size() < static_cast<std::size_t>(population.size)) {
    Eigen::Vector4d even;
    even << normal_pair(random), normal_pair(random);
    const Eigen::Vector4d drawn = root * even;
    if (drawn.cwiseAbs().maxCoeff() > kMostDeviations) continue;
    people.push_back({.length = 1.0 + population.length_sd * drawn[0],
                      .breadth = 1.0 + population.breadth_sd * drawn[1],
                      .depth = 1.0 + population.depth_sd * drawn[2],
                      .modulus = std::exp(spread * drawn[3] - 0.5 * spread * spread)});
  }
  return people;
}

std::shared_ptr<const FingerModel> finger_of(const std::shared_ptr<const FingerModel>& model,
                                             const PersonFactors& person, const std::string& text) {
  if (person == PersonFactors{}) return model;
  const FingerSize size = finger_size(*model);
  const auto sized = FingerModel::load(model->file, text,
                                       {.length = *size.length * person.length,
                                        .breadth = *size.breadth * person.breadth,
                                        .depth = *size.depth * person.depth});
  auto own = std::make_shared<FingerModel>(*sized);
  for (FingerModel::Material& material : own->materials) {
    material.youngs_modulus *= person.modulus;
  }
  own->strain_limits.stiffness *= person.modulus;
  return own;
}

}  // namespace softfinger
