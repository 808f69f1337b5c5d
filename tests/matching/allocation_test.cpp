#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <span>

#include "../support/folders.hpp"
#include "pad.hpp"
#include "softfinger/matching/contact_plane.hpp"
#include "softfinger/matching/levenberg_marquardt.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/surface_following.hpp"

// Sanitizers bring their own malloc.
#ifndef SOFTFINGER_SANITIZED

namespace {
std::atomic<long> allocations{0};
}

extern "C" void* __libc_malloc(std::size_t size);  // NOLINT: glibc's own
/// Counts what this program takes from the heap: operator new and Eigen end here.
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}

namespace softfinger {
namespace {

TEST(Allocation, SolvesAndTicksDoNotAllocate) {
  std::mt19937 random(1);
  std::vector<Pad> pads;
  std::vector<ContactSet> contacts;
  for (int i = 0; i < 60; ++i) {
    pads.push_back(random_press(random, 45.0));
    ContactSet contact;
    contact.samples.resize(pads.back().points.size());
    for (std::size_t k = 0; k < contact.samples.size(); ++k) {
      contact.samples[k].position_F = pads.back().points[k];
      contact.samples[k].gap = pads.back().gaps[k];
      contact.samples[k].in_contact = pads.back().in_contact[k] != 0 && i % 5 != 0;
      contact.contact_count += contact.samples[k].in_contact ? 1 : 0;
      contact.least_gap = std::min(contact.least_gap, contact.samples[k].gap + (i % 3) * 2e-3);
    }
    contacts.push_back(contact);
  }
  int devices = 0;
  for (const auto& file : std::filesystem::directory_iterator(source_folder() + "/devices")) {
    if (file.path().extension() != ".toml") continue;
    const auto device = load_device(file.path());
    // Files that differ by their motors alone match as one.
    if (device->settings().transport && device->settings().transport->kind != "maestro") continue;
    ContactSurfaceMatching matching(device, 120);
    SurfaceFollowing rendering(device, 120);
    LevenbergMarquardt published(*device);
    PackedSamples packed(120);
    const long before = allocations;
    int touched = 0;
    // Mechanisms take long where little closes.
    const std::size_t tried = device->kind() == "mechanism" ? 6 : pads.size();
    for (const Pad& pad : std::span(pads).first(tried)) {
      for (const MatchingLimits limits :
           {MatchingLimits::kInside, MatchingLimits::kClamp, MatchingLimits::kNone}) {
        MatchingOptions options;
        options.limits = limits;
        touched += matching.solve(pad.view(), options).iterations;
      }
    }
    for (const Pad& pad : std::span(pads).first(tried)) {
      const SurfaceSamples samples = packed.pack(pad.view(), {}, 0.2 * mm);
      touched += published.minimise(samples, device->home()).iterations;
      touched += on_plane(*device, {pad.points[0], Vector3::UnitZ()}).size() > 0 ? 1 : 0;
    }
    for (const ContactSet& contact : std::span(contacts).first(tried))
      rendering.tick(contact, 1.0 / 30.0);
    EXPECT_EQ(allocations - before, 0) << file.path();
    EXPECT_GT(touched, 0);
    ++devices;
  }
  EXPECT_GE(devices, 10);
  const long before = allocations;
  const std::vector<double> counted(17);
  EXPECT_GT(allocations - before, 0) << counted.size();
}

}  // namespace
}  // namespace softfinger

#endif
