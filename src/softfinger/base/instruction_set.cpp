#include "softfinger/base/instruction_set.hpp"

#include <fmt/format.h>

#include <atomic>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

std::atomic<InstructionSet>& chosen() {
  static std::atomic<InstructionSet> set{best_instruction_set()};
  return set;
}

}  // namespace

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
  const auto* const row = row_named(kInstructionSets, name);
  if (row == nullptr) {
    throw InputError(fmt::format("--simd {}: unknown instruction set; known: {}", name,
                                 fmt::join(names_of(kInstructionSets), ", ")));
  }
  if (row->value > best_instruction_set()) {
    throw InputError(fmt::format("--simd {}: this processor has no {}; its best is {}", name, name,
                                 name_of(best_instruction_set())));
  }
  chosen().store(row->value, std::memory_order_relaxed);
}

}  // namespace softfinger
