#include "softfinger/finger/skin_places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "../support/box_finger.hpp"

namespace softfinger {
namespace {

using testing_support::box_finger;

TEST(SkinPlaces, StandForAllOfTheSkin) {
  const auto model = box_finger();
  const double whole =
      std::accumulate(model->sample_rest_areas.begin(), model->sample_rest_areas.end(), 0.0);
  for (const double spacing : {0.7e-3, 2e-3, 20e-3}) {
    const auto [places, areas] = even_places(*model, spacing);
    ASSERT_EQ(places.size(), areas.size());
    EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), whole, 1e-12 * whole);
    EXPECT_GE(places.size(), model->skin_triangles.size());
    EXPECT_LE(*std::ranges::max_element(areas), 0.5 * spacing * spacing);
    for (const SkinPlace& place : places) {
      EXPECT_NEAR(place.weights[0] + place.weights[1] + place.weights[2], 1.0, 1e-12);
      EXPECT_GT(*std::ranges::min_element(place.weights), 0.0);
    }
  }
}

TEST(SkinPlaces, HaveTheMeanOfAnyLinearFunction) {
  const auto model = box_finger();
  const auto [places, areas] = even_places(*model, 1.1e-3);
  Vector3 by_places = Vector3::Zero();
  Vector3 by_samples = Vector3::Zero();
  for (std::size_t k = 0; k < places.size(); ++k) {
    by_places += areas[k] * rest_position(*model, places[k]);
  }
  for (std::size_t i = 0; i < model->sample_nodes.size(); ++i) {
    by_samples += model->sample_rest_areas[i] *
                  model->mesh.nodes[static_cast<std::size_t>(model->sample_nodes[i])];
  }
  EXPECT_LT((by_places - by_samples).norm(), 1e-12 * by_samples.norm());
}

TEST(RestingSkin, FindsTheNearestPlace) {
  const auto model = box_finger();
  const RestingSkin skin(*model);
  const auto [places, areas] = even_places(*model, 0.15e-3);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-9e-3, 9e-3);
  for (int n = 0; n < 60; ++n) {
    const Vector3 p(anywhere(random), anywhere(random), anywhere(random));
    const SkinPlace found = skin.nearest(p);
    EXPECT_GE(*std::ranges::min_element(found.weights), 0.0);
    const double distance = (rest_position(*model, found) - p).norm();
    double least = 1.0;
    for (const SkinPlace& place : places) {
      least = std::min(least, (rest_position(*model, place) - p).norm());
    }
    EXPECT_LE(distance, least);
    EXPECT_GE(distance, least - 0.15e-3);
  }
  for (std::size_t k = 0; k < places.size(); k += 97) {
    const Vector3 p = rest_position(*model, places[k]);
    EXPECT_LT((rest_position(*model, skin.nearest(p)) - p).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
