#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/study/journal.hpp"
#include "softfinger/study/ranks.hpp"
#include "softfinger/study/study.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {

struct StudyOptions {
  std::filesystem::path out;   ///< the study's folder
  std::optional<Shard> shard;  ///< empty: all of it
};

/// How far a study is.
struct StudyProgress {
  std::size_t cases = 0;       ///< a design worn by one person each, of the whole study
  std::size_t done = 0;        ///< of them, those recorded before included
  std::size_t recorded = 0;    ///< of those, recorded before this run
  std::size_t designs = 0;     ///< of which all cases are done
  std::size_t infeasible = 0;  ///< of those
};

struct StudyObserver {
  std::function<void(const std::string&)> message;     ///< one line for people
  std::function<void(const StudyProgress&)> progress;  ///< on any thread, one at a time
  /// All of a design is known, which may have been so before; on any thread, one at a time.
  std::function<void(const StudyRow&)> design;
};

enum class StudyEnd {
  kFinished,      ///< every design is known
  kShardDone,     ///< this shard's part is recorded
  kAwaitsOthers,  ///< so is its part of this generation; the next one needs the others'
  kStopped
};
/// For people.
[[nodiscard]] std::string_view name_of(StudyEnd end);

struct StudySummary {
  StudyEnd end = StudyEnd::kFinished;
  StudyProgress progress;
  std::string first_reason;  ///< of the first design that is not feasible; empty: all are
};

[[nodiscard]] StudyHeadings headings_of(const Study& study);

/// Evaluates what is not recorded yet and records it in the study's folder, on all `ranks`, every
/// one of which calls it alike; rank 0 alone has a summary and an observer's ear. The same folder
/// comes out whatever the ranks, the shards, and however often it was killed. Throws InputError and
/// OperationError, see Journal and search(), on every rank, and on others than 0 without words.
[[nodiscard]] StudySummary run_study(const Study& study, const StudyOptions& options, Ranks& ranks,
                                     const std::atomic<bool>& stop,
                                     const StudyObserver& observer = {});

}  // namespace softfinger
