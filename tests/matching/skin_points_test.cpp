#include "softfinger/matching/skin_points.hpp"

#include <gtest/gtest.h>

#include "softfinger/base/units.hpp"
#include "softfinger/matching/packed_samples.hpp"

namespace softfinger {
namespace {

/// Three samples that touch, with 4, 1 and 0.25 kPa, and one that does not.
ContactSet four_samples(bool on_soft) {
  ContactSet contact;
  for (const double pressure : {4e3, 1e3, 250.0, 0.0}) {
    ContactSample sample;
    sample.rest_area = sample.area = 2.0 * mm * mm;
    sample.normal_force = pressure * sample.area;
    sample.in_contact = pressure > 0.0;
    sample.on_soft = on_soft;
    sample.gap = sample.in_contact ? 0.0 : 1.0 * mm;
    contact.samples.push_back(sample);
  }
  contact.contact_count = 3;
  return contact;
}

std::vector<double> weights_of(const ContactSet& contact, MatchingWeights weights) {
  SkinPoints points(4);
  PackedSamples packed(4);
  const SurfaceSamples samples = packed.pack(points.take(contact), {.weights = weights}, 0.5 * mm);
  return {samples.weight.begin(), samples.weight.end()};
}

TEST(SkinPoints, OnSomethingSoftCountByTheirPressure) {
  for (const MatchingWeights weights : {MatchingWeights::kUniform, MatchingWeights::kArea}) {
    EXPECT_EQ(weights_of(four_samples(true), weights), (std::vector{1.0, 0.25, 0.0625, 1.0}));
    EXPECT_EQ(weights_of(four_samples(false), weights), (std::vector{1.0, 1.0, 1.0, 1.0}));
  }
}

TEST(SkinPoints, OnSomethingHardBesideSomethingSoftCountInFull) {
  ContactSet contact = four_samples(true);
  contact.samples[0].on_soft = false;
  EXPECT_EQ(weights_of(contact, MatchingWeights::kUniform), (std::vector{1.0, 1.0, 0.25, 1.0}));
}

}  // namespace
}  // namespace softfinger
