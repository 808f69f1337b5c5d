#pragma once

#include <atomic>

#include "softfinger/study/contacts/contact_file.hpp"
#include "softfinger/study/contacts/contact_study.hpp"
#include "softfinger/study/run_study.hpp"

namespace softfinger {

/// Of a study that has contacts in the place of designs, and so no parameters.
[[nodiscard]] StudyHeadings headings_of(const ContactStudy& study);

/// As run_study(), of contacts: presses take the place of cases, contacts.h5 that of the journal. A
/// shard has contacts-I-of-N.h5, of which the run without one takes what is there, and removes it.
[[nodiscard]] StudySummary run_contacts(const ContactStudy& study, const StudyOptions& options,
                                        Ranks& ranks, const std::atomic<bool>& stop,
                                        const StudyObserver& observer = {});

/// Copies the contacts of a study's folder, and says how many are there. Throws InputError where it
/// has none, or `to` exists or does not end in .h5; OperationError where it cannot be written.
ContactsDone export_contacts(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace softfinger
