#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/finger/finger_size.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/tracking/registration/registration.hpp"

namespace softfinger {

/// How a finger lay on a level table when it was registered.
struct TableRest {
  std::vector<PostureCapture> captures;  ///< in the order of RegistrationProcedure::kOrder
  double height = 0.0;                   ///< of the table, z of W, m
  bool height_was_given = false;         ///< else the finger's size told it
};

/// What is known of one of a person's fingers.
struct PersonFinger {
  std::string name;                      ///< as scenes call it
  FingerSize size;                       ///< stands before the finger file's
  std::optional<double> modulus_factor;  ///< of the finger file's Young's moduli
  /// How a device stands on it otherwise than its file says, see DeviceSettings::mount_fit.
  std::optional<Pose> mount;
  std::optional<Pose> X_BodyFt;       ///< distal phalanx in the tracked body; empty: the same
  std::optional<TableRest> on_table;  ///< what that was found by, if it is known
};

/// A person file (TOML, keys in docs/files.md): a table a finger.
struct Person {
  std::filesystem::path file;
  std::string text;  ///< of the file, as read
  std::vector<PersonFinger> fingers;

  /// Null where the file says nothing of this finger.
  [[nodiscard]] const PersonFinger* find(std::string_view name) const;
  /// The same, added where it was not there.
  PersonFinger& at(std::string_view name);
};

/// Throws InputError with file, line and key.
[[nodiscard]] Person load_person(const std::filesystem::path& file);
/// A JSON Schema of person files, by what their reader asks for.
[[nodiscard]] std::string person_schema();
/// The same; nothing known of any finger where there is no such file.
[[nodiscard]] Person load_person_if_any(const std::filesystem::path& file);

/// Writes what of `person` is not as its text has it in place of the file, at once or not at all:
/// the rest of the file stays as it is written, comments too. Throws OperationError.
void save_person(const Person& person);

}  // namespace softfinger
