#include "softfinger/base/instruction_set.hpp"

#include <array>
#include <atomic>
#include <string>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

constexpr std::array<std::pair<InstructionSet, std::string_view>, 3> kNames{{
    {InstructionSet::kBaseline, "baseline"},
    {InstructionSet::kAvx2, "avx2"},
    {InstructionSet::kAvx512, "avx512"},
}};

std::atomic<InstructionSet>& chosen() {
  static std::atomic<InstructionSet> set{best_instruction_set()};
  return set;
}

}  // namespace

std::string_view name_of(InstructionSet set) {
  for (const auto& [value, name] : kNames) {
    if (value == set) return name;
  }
  return "unknown";
}

InstructionSet best_instruction_set() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    return InstructionSet::kAvx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::kAvx2;
#endif
  return InstructionSet::kBaseline;
}

InstructionSet active_instruction_set() { return chosen().load(std::memory_order_relaxed); }

void choose_instruction_set(std::string_view name) {
  for (const auto& [value, known] : kNames) {
    if (known != name) continue;
    if (value > best_instruction_set()) {
      throw InputError("--simd " + std::string(name) + ": this processor has no " +
                       std::string(name) + "; its best is " +
                       std::string(name_of(best_instruction_set())));
    }
    chosen().store(value, std::memory_order_relaxed);
    return;
  }
  throw InputError("--simd " + std::string(name) +
                   ": unknown instruction set; known: baseline, avx2, avx512");
}

}  // namespace softfinger
