// malloc and its kin, which operator new calls too, are replaced for this program; a thread counts
// its own calls while it asks to. Sanitizers replace them themselves, so there is nothing to see.
#ifndef SOFTFINGER_SANITIZED

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

thread_local bool counting = false;
thread_local int allocations = 0;

void count() {
  if (counting) ++allocations;
}

}  // namespace

extern "C" {
void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
void* realloc(void* block, std::size_t size) {
  count();
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
}

namespace softfinger {
namespace {

TEST(ActuatorAllocation, TheCounterSeesAllocations) {
  allocations = 0;
  counting = true;
  const auto some = std::make_unique<std::array<double, 100>>();
  counting = false;
  EXPECT_NE(some, nullptr);
  EXPECT_GE(allocations, 1);
}

TEST(ActuatorAllocation, CommandsAllocateNothing) {
  const auto device = lever_platform({.wedge = true});
  for (const bool simulated_time : {true, false}) {
    Actuator actuator(device, {.simulated_time = simulated_time});
    WantedMotion wanted{.configuration = device->home()};
    JointAngles servos = device->home();
    actuator.command(wanted, 0.0);
    allocations = 0;
    counting = true;
    for (int k = 1; k < 3000; ++k) {
      wanted.configuration[0] = std::sin(0.11 * k);
      wanted.configuration[1] = std::cos(0.07 * k);
      wanted.configuration[2] = 0.02 * std::sin(0.23 * k);
      wanted.tracked = k % 100 < 90;
      wanted.touching = k % 3 == 0;
      actuator.command(wanted, k / 30.0);
      (void)actuator.read_servo_joints(servos);
      (void)actuator.take_event();
    }
    counting = false;
    EXPECT_EQ(allocations, 0) << simulated_time;
  }
}

}  // namespace
}  // namespace softfinger

#endif
