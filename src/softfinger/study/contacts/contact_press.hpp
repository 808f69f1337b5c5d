#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/study/contacts/contact_study.hpp"

namespace softfinger {

/// Contacts of one press, one after the other, as they are kept: floats in the units of files, what
/// belongs to F expressed in it.
struct PressedContacts {
  // A number a contact.
  std::vector<float> indentation_mm, normal_force_N, tangential_force_N, contact_area_mm2;
  std::vector<std::uint8_t> converged;
  // A number, or three, a contact and node or sample.
  std::vector<float> nodes_mm, gap_mm, pressure_kPa, force_N;
  std::vector<std::uint8_t> in_contact;

  [[nodiscard]] std::string bytes() const;
  /// Throws OperationError where they are not what bytes() gives.
  [[nodiscard]] static PressedContacts of_bytes(std::string_view bytes);
};

/// Makes the presses of a study; keeps people's fingers. One thread.
class ContactPress {
 public:
  /// `study` must outlive it.
  explicit ContactPress(const ContactStudy& study);

  /// Not converged, and zero, where the finger comes down beside the object.
  [[nodiscard]] PressedContacts press(std::size_t number);
  [[nodiscard]] const FingerModel& nominal() const { return *nominal_; }
  [[nodiscard]] const PersonFactors& person(std::size_t number) const { return people_[number]; }

 private:
  std::shared_ptr<const FingerModel> finger(std::size_t person);

  const ContactStudy& study_;
  std::vector<PersonFactors> people_;
  std::shared_ptr<const FingerModel> nominal_;
  std::map<std::size_t, std::shared_ptr<const FingerModel>> fingers_;
};

}  // namespace softfinger
