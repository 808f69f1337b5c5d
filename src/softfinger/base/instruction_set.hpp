#pragma once

#include <array>
#include <string_view>

#include "softfinger/base/name_table.hpp"

namespace softfinger {

/// Instruction sets the numerical kernels are compiled for. All give the same answers up to
/// rounding; the same set gives the same bits.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };
inline constexpr std::array<NameRow<InstructionSet>, 3> kInstructionSets{{
    {InstructionSet::kBaseline, "baseline"},
    {InstructionSet::kAvx2, "avx2"},
    {InstructionSet::kAvx512, "avx512"},
}};

/// "baseline", "avx2" or "avx512".
[[nodiscard]] constexpr std::string_view name_of(InstructionSet set) {
  return row_of(kInstructionSets, set).name;
}
/// The best set this processor runs.
[[nodiscard]] InstructionSet best_instruction_set();
/// The set kernels use from now on; best_instruction_set() until chosen.
[[nodiscard]] InstructionSet active_instruction_set();
/// Chooses by name, before anything is built on it. Throws InputError for an unknown name or a set
/// that this processor lacks.
void choose_instruction_set(std::string_view name);

}  // namespace softfinger
