#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "softfinger/study/case.hpp"
#include "softfinger/study/study.hpp"

namespace softfinger {

/// Something that outcomes follow from.
struct StudyFact {
  std::string what;   ///< "the program", or a file as the study calls it
  std::string value;  ///< differs where it does
};

/// All that the outcome of a case follows from besides the case: this program, its instruction
/// set, the study, and every file that it or a file of its names, down to meshes.
[[nodiscard]] std::vector<StudyFact> study_facts(const Study& study);

/// The same of a study file of another kind, and the files it names.
[[nodiscard]] std::vector<StudyFact> study_facts(const std::filesystem::path& study,
                                                 const std::string& text,
                                                 const std::vector<const StudyFile*>& files);
/// Throws InputError, which names what differs, where what `where` holds followed from others.
void refuse_other_facts(const std::filesystem::path& where,
                        const std::map<std::string, std::string>& then,
                        const std::vector<StudyFact>& now);

/// One number for all of them.
[[nodiscard]] std::uint64_t hash_of(const std::vector<StudyFact>& facts);
/// And of a case of a study with these facts.
[[nodiscard]] std::uint64_t key_of(std::uint64_t facts, const StudyCase& one);

}  // namespace softfinger
