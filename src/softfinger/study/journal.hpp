#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "softfinger/study/case.hpp"
#include "softfinger/study/study_facts.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// Which part of a study's cases a process evaluates: those whose number leaves this remainder.
struct Shard {
  std::size_t number = 1, count = 1;  ///< from 1
  [[nodiscard]] bool has(std::size_t index) const { return index % count == number - 1; }
};

/// What is known of a study: every outcome, as it came, and every design once all of it is known.
/// One SQLite file in the study's folder, written by one process; a shard's is its own. Whatever
/// ends that process, what was recorded stays. One thread at a time.
class Journal {
 public:
  using Say = std::function<void(const std::string&)>;  ///< one line for people

  /// Opens or makes it in `folder`, which is made, too. Without a shard takes in what shards have
  /// recorded. Of one that is damaged what can be read is kept, and said. Throws InputError where
  /// it is of another study, of other files or of another program, and names that, or where
  /// another process writes it; OperationError where it cannot be written.
  Journal(const std::filesystem::path& folder, const std::optional<Shard>& shard,
          const std::vector<StudyFact>& facts, const StudyHeadings& headings, const Say& say);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Null: not known.
  [[nodiscard]] const CaseOutcome* find(std::uint64_t key) const;
  [[nodiscard]] std::size_t size() const { return known_.size(); }
  /// Throws OperationError where it cannot be written.
  void add(std::uint64_t key, const CaseOutcome& outcome);
  void add(const StudyRow& row);
  /// Of all designs every one is recorded.
  void finish();
  /// What other shards have recorded meanwhile.
  void look_at_others();

 private:
  struct Files;

  void read(const std::filesystem::path& file, bool is_own);
  void begin(const std::vector<StudyFact>& facts, const StudyHeadings& headings);
  void merge_shards();

  std::filesystem::path folder_, file_;
  Say say_;
  std::vector<StudyFact> facts_;
  std::unordered_map<std::uint64_t, CaseOutcome> known_;
  std::unique_ptr<Files> files_;
};

}  // namespace softfinger
