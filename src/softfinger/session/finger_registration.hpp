#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/person/person.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/session/run_observer.hpp"
#include "softfinger/tracking/registration/registration.hpp"

namespace softfinger {

/// Which finger of whom is registered, and by what.
struct FingerRegistrationOptions {
  std::filesystem::path person;  ///< file to write or change
  std::string finger = "index";  ///< whose tables are written
  std::filesystem::path scene;   ///< whose finger it is, where its name is none of a hand's
  FingerSize measured;           ///< by hand
  std::string tracker;           ///< of the body on the finger; empty: sizes alone are written
  std::filesystem::path model;   ///< finger file whose shape is fitted, with a tracker
  std::optional<double> table_height;  ///< z of W, m; without sizes, the finger's is found
};

/// What whoever is registered is told meanwhile.
struct FingerRegistrationObserver : RunObserver {
  std::function<void(const std::string&)> ask;  ///< for the next posture
};

struct FingerRegistration {
  PersonFinger finger;                ///< as the person file has it now
  std::optional<Registration> found;  ///< empty: sizes alone were written
};

/// Trackers whose body can be registered without a page, for people: "a, b or c".
[[nodiscard]] std::string registering_trackers(std::string_view last = "or");

/// Takes five postures on a table from the tracker, each once it is held still, in the time of its
/// file, else by the clock; or nothing where sizes alone are given. Then writes the person's file.
/// Throws InputError for what is wrong, OperationError where `stop` became true or the file cannot
/// be written; then nothing is.
[[nodiscard]] FingerRegistration register_one(const FingerRegistrationOptions& options,
                                              const std::atomic<bool>& stop,
                                              const FingerRegistrationObserver& observer = {});

}  // namespace softfinger
