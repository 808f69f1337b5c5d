#include "softfinger/study/study_facts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <string_view>

#include "softfinger/base/code_hash.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/base/instruction_set.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

void add(Hash& hash, std::string_view text) {
  hash.add(text.size()).add(std::span<const char>(text));
}

std::string hash_text(std::string_view content) {
  Hash hash;
  add(hash, content);
  return fmt::format("{:016x}", hash.value());
}

/// What a word of a file names, where that is a file: "csv:poses.csv" as well as "index.msh".
/// Other TOML files are a study's own to name.
fs::path named_by(std::string_view word, const fs::path& directory) {
  std::error_code error;
  for (const std::string_view part : {word, word.substr(word.find(':') + 1)}) {
    if (part.empty() || part.size() > 1000 || part.ends_with(".toml")) continue;
    fs::path file = directory / part;
    if (fs::is_regular_file(file, error)) return file;
  }
  return {};
}

}  // namespace

std::vector<StudyFact> study_facts(const Study& study) {
  std::vector<const StudyFile*> files;
  for (const StudyFile& scene : study.scenes) files.push_back(&scene);
  if (study.finger) files.push_back(&*study.finger);
  files.push_back(&study.device);
  return study_facts(study.file, study.text, files);
}

std::vector<StudyFact> study_facts(const fs::path& study, const std::string& text,
                                   const std::vector<const StudyFile*>& files) {
  std::vector<StudyFact> facts{
      {"the program", fmt::format("{} {:016x}", SOFTFINGER_VERSION, code_hash())},
      {"the instruction set", std::string(name_of(active_instruction_set()))},
      {study.filename().string(), hash_text(text)},
  };
  std::set<fs::path> seen;
  const auto add_file = [&](const StudyFile& file) {
    facts.push_back({file.written, hash_text(file.text.text())});
    for (const std::string& word : file.text.words()) {
      const fs::path named = named_by(word, file.path.parent_path());
      if (named.empty() || !seen.insert(fs::weakly_canonical(named)).second) continue;
      std::ifstream stream(named, std::ios::binary);
      const std::string content{std::istreambuf_iterator<char>(stream), {}};
      facts.push_back({named.lexically_normal()
                           .lexically_proximate(study.parent_path().lexically_normal())
                           .string(),
                       hash_text(content)});
    }
  };
  for (const StudyFile* file : files) add_file(*file);
  return facts;
}

void refuse_other_facts(const fs::path& where, const std::map<std::string, std::string>& then,
                        const std::vector<StudyFact>& now) {
  for (const StudyFact& fact : now) {
    const auto known = then.find(fact.what);
    if (known != then.end() && known->second == fact.value) continue;
    if (fact.what == "the program") {
      throw InputError(fmt::format(
          "{}: was begun by another build of the program ({}, this is {}), which may compute other "
          "numbers; go on with that one, or give another --out",
          where.string(), known == then.end() ? "unknown" : known->second, fact.value));
    }
    if (fact.what == "the instruction set") {
      throw InputError(
          fmt::format("{}: was begun with the instruction set {}, and this processor has {}; go on "
                      "where it was "
                      "begun, or give another --out",
                      where.string(), known == then.end() ? "unknown" : known->second, fact.value));
    }
    throw InputError(
        fmt::format("{}: was begun with another content of {}; put that back, or give "
                    "another --out",
                    where.string(), fact.what));
  }
  for (const auto& [what, value] : then) {
    if (std::ranges::find(now, what, &StudyFact::what) == now.end()) {
      throw InputError(
          fmt::format("{}: was begun with {}, which is no longer part of the study; "
                      "put that back, or give another --out",
                      where.string(), what));
    }
  }
}

std::uint64_t hash_of(const std::vector<StudyFact>& facts) {
  Hash hash;
  for (const StudyFact& fact : facts) {
    add(hash, fact.what);
    add(hash, fact.value);
  }
  return hash.value();
}

std::uint64_t key_of(std::uint64_t facts, const StudyCase& one) {
  Hash hash;
  hash.add(facts).add(one.person).add(std::span<const double>(one.design));
  return hash.value();
}

}  // namespace softfinger
