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

/// Puts X_BodyFt of the captures, and the size, into `person`. With the table's height and no
/// measured size, the person's size is the finger file's in its proportions; else it is the
/// measured one, the person file's, the finger file's, in this order. Throws InputError, see
/// register_finger(); `person` is then as before.
Registration register_person(Person& person, const RegistrationTask& task,
                             std::span<const PostureCapture> captures);

/// `sizes` with those of `other` where it has none.
[[nodiscard]] FingerSize completed(const FingerSize& sizes, const FingerSize& other);

}  // namespace softfinger
