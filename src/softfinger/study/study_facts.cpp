#include "softfinger/study/study_facts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <string_view>

#include "softfinger/base/code_hash.hpp"
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
  std::vector<StudyFact> facts{
      {"the program", fmt::format("{} {:016x}", SOFTFINGER_VERSION, code_hash())},
      {"the instruction set", std::string(name_of(active_instruction_set()))},
      {study.file.filename().string(), hash_text(study.text)},
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
                           .lexically_proximate(study.file.parent_path().lexically_normal())
                           .string(),
                       hash_text(content)});
    }
  };
  for (const StudyFile& scene : study.scenes) add_file(scene);
  if (study.finger) add_file(*study.finger);
  add_file(study.device);
  return facts;
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
