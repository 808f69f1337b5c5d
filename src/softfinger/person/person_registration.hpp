#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/tracking/registration/registration.hpp"

namespace softfinger {

/// What is known of a finger before it is registered.
struct RegistrationTask {
  std::string finger;                  ///< its name in the person file
  std::filesystem::path model;         ///< finger file, for shape and proportions
  FingerSize measured;                 ///< stands before what the person file says
  std::optional<double> table_height;  ///< z of W, m; up to kHighestTable, either way

  static constexpr double kHighestTable = 5.0;  ///< m
};

/// Puts X_BodyFt of the captures, these and the size into `person`. With the table's height, no
/// measured size and no device that has learned it, the person's size is the finger file's in its
/// proportions; else it is the measured one, the person file's, the finger file's, in this order.
/// Throws InputError, see register_finger(); `person` is then as before.
Registration register_person(Person& person, const RegistrationTask& task,
                             std::span<const PostureCapture> captures);

/// X_BodyFt anew, for a finger whose size has become better known since it lay on the table;
/// nothing where it did not. `model` is the finger file whose shape it has. Throws InputError where
/// skin of that size cannot have lain so; `finger` is then as before.
std::optional<Registration> register_again(PersonFinger& finger,
                                           const std::filesystem::path& model);

/// `sizes` with those of `other` where it has none.
[[nodiscard]] FingerSize completed(const FingerSize& sizes, const FingerSize& other);

}  // namespace softfinger
