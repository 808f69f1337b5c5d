#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// What `[matching] objective` of a device file may say, the first where it says nothing. What they
/// are stands in objectives/objective_kinds.cpp, which does not compile where this differs from it.
/// Recordings know them by their place here: new ones come last.
inline constexpr std::array<std::string_view, 5> kDeviceObjectives{"surface", "surface_and_force",
                                                                   "stress", "published", "plane"};

/// A name that files and flags had before, and what is meant by it.
struct FormerObjective {
  std::string_view name, now;
};
inline constexpr std::array kFormerObjectives{FormerObjective{"contact_plane", "plane"}};

/// All names that files and flags may use, former ones among them.
[[nodiscard]] inline std::vector<std::string> objective_words() {
  std::vector<std::string> words;
  words.reserve(kDeviceObjectives.size() + kFormerObjectives.size());
  for (const std::string_view name : kDeviceObjectives) words.emplace_back(name);
  for (const FormerObjective& former : kFormerObjectives) words.emplace_back(former.name);
  return words;
}

/// `name`, or what it is called now.
constexpr std::string_view present_objective(std::string_view name) {
  const auto* const former = std::ranges::find(kFormerObjectives, name, &FormerObjective::name);
  return former == kFormerObjectives.end() ? name : former->now;
}

}  // namespace softfinger
