#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/study/population.hpp"
#include "softfinger/study/study.hpp"
#include "softfinger/study/study_facts.hpp"

namespace softfinger {

/// What a finger is pressed on.
enum class PressedOn { kPlane, kSphere, kEdge };
inline constexpr std::array<NameRow<PressedOn>, 3> kPressedOn{{
    {PressedOn::kPlane, "plane"},
    {PressedOn::kSphere, "sphere"},
    {PressedOn::kEdge, "edge"},
}};

/// Even between two numbers, SI, or even in their logarithms.
struct Spread {
  double min = 0.0, max = 0.0;
  bool log = false;
  [[nodiscard]] double at(double u) const;
};

/// A study of `kind = "contacts"`: presses of one finger whose people, objects and poses are drawn,
/// a contact at each of some depths.
struct ContactStudy {
  std::filesystem::path file;
  std::string text;
  StudyFile finger;
  Population population;
  std::vector<PressedOn> shapes;
  Spread radius, edge_radius;  ///< m
  Spread at;                   ///< of a sphere's middle along x and y of F, m
  Spread pitch;                ///< of the finger, distal end down, rad
  Spread depth;                ///< greatest of a press, m
  Spread friction;             ///< coefficient
  std::size_t contacts_a_press = 10;
  std::size_t size = 0;  ///< contacts in all
  std::uint32_t seed = 1;

  [[nodiscard]] std::size_t presses() const { return size / contacts_a_press; }
};

/// What was drawn for one press; SI.
struct DrawnPress {
  std::size_t person = 0;
  PressedOn shape = PressedOn::kPlane;
  double radius = 0.0;  ///< of the sphere, or of the edge's rounding; 0 of a plane
  double at_x = 0.0, at_y = 0.0, pitch = 0.0, depth = 0.0, friction = 0.0;
};

/// Whether a study file says kind = "contacts". Throws InputError where it cannot be read.
[[nodiscard]] bool is_contact_study(const std::filesystem::path& file);
/// Throws InputError with file, line and key.
[[nodiscard]] ContactStudy load_contact_study(const std::filesystem::path& file);
/// The same for the same study and number, whatever was drawn before.
[[nodiscard]] DrawnPress draw_press(const ContactStudy& study, std::size_t number);
/// See study_facts().
[[nodiscard]] std::vector<StudyFact> contact_facts(const ContactStudy& study);

}  // namespace softfinger
