#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/study/contacts/contact_press.hpp"
#include "softfinger/study/study_facts.hpp"

namespace softfinger {

inline constexpr const char* kContactFileName = "contacts.h5";

/// How many presses of a file of contacts are there, and how many there are to be.
struct ContactsDone {
  std::size_t done = 0, all = 0;
};
/// Throws InputError where it is damaged, or no such file.
[[nodiscard]] ContactsDone contacts_done(const std::filesystem::path& file);

/// The contacts of a study as an HDF5 file, a row a contact, and with it how far the study is. All
/// of it has its place from the start, so that a press goes where it belongs, whoever made it and
/// when, and whatever ends the program what is written stays. One thread at a time. Throws
/// OperationError where it cannot be written.
class ContactFile {
 public:
  /// Opens or makes it. Throws InputError where it is of another study, file or program, and names
  /// that, or is no such file.
  ContactFile(const std::filesystem::path& file, const ContactStudy& study,
              const ContactPress& press, const std::vector<StudyFact>& facts);
  ~ContactFile();
  ContactFile(const ContactFile&) = delete;
  ContactFile& operator=(const ContactFile&) = delete;

  [[nodiscard]] bool has(std::size_t press) const;
  [[nodiscard]] std::size_t done() const;
  void write(std::size_t press, const PressedContacts& contacts);
  [[nodiscard]] PressedContacts read(std::size_t press);
  void close();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
