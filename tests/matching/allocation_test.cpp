#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "pad.hpp"
#include "softfinger/matching/surface_rendering.hpp"

// Sanitizers bring their own malloc.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

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

/// Solves and ticks of one device.
void expect_no_allocation(const std::shared_ptr<const Device>& device) {
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
<<<<<<< HEAD
  for (const auto& file : std::filesystem::directory_iterator(SOFTFINGER_SOURCE_DIR "/devices")) {
    if (file.path().extension() != ".toml") continue;
    const auto device = load_device(file.path());
    ContactSurfaceMatching matching(device, 120);
    SurfaceRendering rendering(device, 120);
    const long before = allocations;
    int touched = 0;
    for (const Pad& pad : pads) {
      for (const MatchingLimits limits :
           {MatchingLimits::kInside, MatchingLimits::kClamp, MatchingLimits::kNone}) {
        MatchingOptions options;
        options.limits = limits;
        touched += matching.solve(pad.view(), options).iterations;
      }
=======
  ContactSurfaceMatching matching(device, 120);
  SurfaceRendering rendering(device, 120);
  const long before = allocations;
  int touched = 0;
  for (const Pad& pad : pads) {
    for (const MatchingLimits limits :
         {MatchingLimits::kInside, MatchingLimits::kClamp, MatchingLimits::kNone}) {
      MatchingOptions options;
      options.limits = limits;
      touched += matching.solve(pad.view(), options).iterations;
>>>>>>> 790a77c (Mechanisms: tests against the closed form, refusals, docs, two more examples)
    }
    for (const ContactSet& contact : contacts) rendering.tick(contact);
    EXPECT_EQ(allocations - before, 0) << file.path();
    EXPECT_GT(touched, 0);
  }
  const long before = allocations;
  const std::vector<double> counted(17);
  EXPECT_GT(allocations - before, 0) << counted.size();
}

TEST(Allocation, SolvesAndTicksDoNotAllocate) { expect_no_allocation(thimble()); }

TEST(Allocation, NeitherDoMechanisms) {
  for (const std::string name : {"thimble-3rrs-mechanism", "five-bar"}) {
    expect_no_allocation(load_device(SOFTFINGER_SOURCE_DIR "/devices/" + name + ".toml"));
  }
}

}  // namespace
}  // namespace softfinger

#endif
