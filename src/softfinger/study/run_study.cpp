#include "softfinger/study/run_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <map>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/study/case_evaluation.hpp"
#include "softfinger/study/sampling.hpp"
#include "softfinger/study/search.hpp"

namespace softfinger {
namespace {

/// Of a design that is not feasible, as a search sees it: worse than any that is, and the worse the
/// more its constraints are hurt.
constexpr double kInfeasible = 1e9;
constexpr double kUnbuilt = 1e12;

/// What one rank tells others: a list of texts.
std::string packed(const std::vector<std::string>& texts) {
  std::string bytes;
  for (const std::string& text : texts) {
    const std::uint64_t size = text.size();
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size).append(text);
  }
  return bytes;
}

std::vector<std::string> unpacked(std::string_view bytes) {
  std::vector<std::string> texts;
  while (bytes.size() >= sizeof(std::uint64_t)) {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    texts.emplace_back(bytes.substr(sizeof size, size));
    bytes = bytes.substr(sizeof size + size);
  }
  return texts;
}

// The first letter of a result.
constexpr char kOutcome = 'o';
constexpr char kFailure = 'f';

std::string evaluated(CaseEvaluation& evaluation, const StudyCase& one) {
  try {
    return kOutcome + evaluation.evaluate(one).bytes();
  } catch (const std::exception& error) {
    return kFailure + std::string(error.what());
  }
}

/// How far a number is beyond a constraint's bounds, and in words; 0: it keeps them.
double beyond(const Quantity& constraint, double value, std::string& why) {
  if (constraint.at_most && value > *constraint.at_most) {
    why = fmt::format("{} is {:.6g}, above {:.6g}", constraint.name, value, *constraint.at_most);
    return value - *constraint.at_most;
  }
  if (constraint.at_least && value < *constraint.at_least) {
    why = fmt::format("{} is {:.6g}, below {:.6g}", constraint.name, value, *constraint.at_least);
    return *constraint.at_least - value;
  }
  return 0.0;
}

/// What thrown here ends a search, whose library must not see the reason.
struct EndOfStudy {
  StudyEnd end;
};

/// Rank 0's side of a study.
class Leader {
 public:
  Leader(const Study& study, const StudyOptions& options, Ranks& ranks, CaseEvaluation& evaluation,
         const std::atomic<bool>& stop, const StudyObserver& observer)
      : study_(study),
        shard_(options.shard),
        ranks_(ranks),
        evaluation_(evaluation),
        stop_(stop),
        observer_(observer),
        quantities_(study.quantities()),
        people_(static_cast<std::size_t>(study.population.size)) {
    const std::vector<StudyFact> facts = study_facts(study);
    facts_ = hash_of(facts);
    journal_.emplace(options.out, options.shard, facts, headings_of(study),
                     [&observer](const std::string& line) {
                       if (observer.message) observer.message(line);
                     });
    progress_.cases = study.plan.size * (study.plan.generations + 1) * people_;
  }

  StudySummary run() {
    StudySummary summary;
    try {
      if (study_.plan.generations > 0) {
        search(study_, [this](const auto& designs) { return fitness(designs); });
      } else {
        batch(sampled_designs(study_));
      }
      if (shard_) {
        summary.end = StudyEnd::kShardDone;
      } else {
        journal_->finish();
      }
    } catch (const EndOfStudy& end) {
      summary.end = end.end;
    }
    summary.progress = progress_;
    summary.first_reason = first_reason_;
    return summary;
  }

 private:
  /// A batch of designs, evaluated and recorded.
  std::vector<StudyRow> batch(const std::vector<std::vector<double>>& chosen) {
    std::vector<StudyRow> rows;
    std::vector<StudyCase> cases;
    for (const std::vector<double>& one : chosen) {
      rows.push_back(
          {.number = next_design_++, .parameters = complete_design(study_.parameters, one)});
      for (std::size_t person = 0; person < people_; ++person) {
        cases.push_back({rows.back().parameters, static_cast<std::uint32_t>(person)});
      }
    }
    keys_.clear();
    for (const StudyCase& one : cases) keys_.push_back(key_of(facts_, one));
    rows_ = std::move(rows);
    begin_rows();
    evaluate(cases);
    if (stop_.load() && !all_known()) throw EndOfStudy{StudyEnd::kStopped};
    if (shard_ && study_.plan.generations > 0 && !all_known()) {
      journal_->look_at_others();
      if (!all_known()) throw EndOfStudy{StudyEnd::kAwaitsOthers};
      for (std::size_t design = 0; design < rows_.size(); ++design) judge(rows_[design], design);
    }
    return rows_;
  }

  /// What is known of them already.
  void begin_rows() {
    missing_.assign(rows_.size(), 0);
    for (std::size_t design = 0; design < rows_.size(); ++design) {
      for (std::size_t i = design * people_; i < (design + 1) * people_; ++i) {
        if (journal_->find(keys_[i]) == nullptr) {
          ++missing_[design];
        } else {
          ++progress_.done;
          ++progress_.recorded;
        }
      }
      if (missing_[design] == 0) conclude(design);
    }
    tell();
  }

  /// Of each case once; the same case may stand in a batch twice.
  void evaluate(const std::vector<StudyCase>& cases) {
    std::vector<std::size_t> open;
    std::map<std::uint64_t, std::vector<std::size_t>> same;
    // Person by person, so that what a rank keeps of one serves the designs that follow.
    for (std::size_t person = 0; person < people_; ++person) {
      for (std::size_t i = person; i < cases.size(); i += people_) {
        if (journal_->find(keys_[i]) != nullptr || (shard_ && !shard_->has(i / people_))) continue;
        std::vector<std::size_t>& alike = same[keys_[i]];
        if (alike.empty()) open.push_back(i);
        alike.push_back(i);
      }
    }
    std::vector<std::string> message{"batch", std::to_string(facts_)};
    for (const std::size_t i : open) message.push_back(cases[i].bytes());
    ranks_.broadcast(packed(message));
    ranks_.share(
        open.size(), [&](std::size_t task) { return evaluated(evaluation_, cases[open[task]]); },
        [&](std::size_t task, std::string_view result) { take(same[keys_[open[task]]], result); },
        stop_);
  }

  void take(const std::vector<std::size_t>& alike, std::string_view result) {
    if (!result.starts_with(kOutcome)) throw OperationError(std::string(result.substr(1)));
    journal_->add(keys_[alike.front()], CaseOutcome::of_bytes(result.substr(1)));
    for (const std::size_t i : alike) {
      ++progress_.done;
      const std::size_t design = i / people_;
      if (--missing_[design] == 0) conclude(design);
    }
    tell();
  }

  /// All of a design is known.
  void conclude(std::size_t design) {
    StudyRow& row = rows_[design];
    judge(row, design);
    ++progress_.designs;
    if (!row.feasible()) {
      ++progress_.infeasible;
      if (first_reason_.empty()) first_reason_ = row.reason;
    }
    if (!shard_) journal_->add(row);
    if (observer_.design) observer_.design(row);
  }

  void judge(StudyRow& row, std::size_t design) const {
    row.reason.clear();
    row.quantities.assign(quantities_.size(), std::nan(""));
    std::vector<const CaseOutcome*> outcomes;
    for (std::size_t person = 0; person < people_; ++person) {
      outcomes.push_back(journal_->find(keys_[design * people_ + person]));
      const std::string& reason = outcomes.back()->reason;
      if (reason.empty()) continue;
      row.reason = people_ == 1 ? reason : fmt::format("person {}: {}", person + 1, reason);
      return;
    }
    std::size_t measure = 0;
    for (std::size_t k = 0; k < quantities_.size(); ++k) {
      const Quantity& quantity = *quantities_[k];
      if (quantity.formula) {
        row.quantities[k] = quantity.formula->value(row.parameters);
      } else {
        std::vector<double> values;
        for (const CaseOutcome* outcome : outcomes) {
          const double value = outcome->values[measure];
          if (!std::isnan(value)) values.push_back(value);
        }
        ++measure;
        if (values.size() < people_ && row.reason.empty()) {
          row.reason = fmt::format("{}: no frame{} has {}", quantity.name,
                                   people_ == 1 ? "" : " of some person", quantity.measure);
        }
        row.quantities[k] = over(std::move(values), quantity.over_people, quantity.maximise);
      }
      if (std::isnan(row.quantities[k]) && row.reason.empty()) {
        row.reason = fmt::format("{}: has no value here", quantity.name);
      }
    }
    for (std::size_t k = study_.objectives.size(); k < quantities_.size(); ++k) {
      std::string why;
      if (row.reason.empty() && beyond(*quantities_[k], row.quantities[k], why) > 0.0) {
        row.reason = why;
      }
    }
  }

  /// What a search makes small.
  std::vector<std::vector<double>> fitness(const std::vector<std::vector<double>>& designs) {
    std::vector<std::vector<double>> result;
    for (const StudyRow& row : batch(designs)) {
      std::vector<double>& one = result.emplace_back();
      double worse = row.feasible() ? 0.0 : kInfeasible;
      for (std::size_t k = 0; k < quantities_.size() && !row.feasible(); ++k) {
        std::string why;
        const double value = row.quantities[k];
        worse += std::isnan(value) ? kUnbuilt : beyond(*quantities_[k], value, why);
      }
      for (std::size_t k = 0; k < study_.objectives.size(); ++k) {
        const double value = quantities_[k]->maximise ? -row.quantities[k] : row.quantities[k];
        one.push_back(row.feasible() ? value : worse);
      }
    }
    return result;
  }

  [[nodiscard]] bool all_known() const {
    return std::ranges::all_of(
        keys_, [this](std::uint64_t key) { return journal_->find(key) != nullptr; });
  }
  void tell() const {
    if (observer_.progress) observer_.progress(progress_);
  }

  const Study& study_;
  std::optional<Shard> shard_;
  Ranks& ranks_;
  CaseEvaluation& evaluation_;
  const std::atomic<bool>& stop_;
  const StudyObserver& observer_;
  std::vector<const Quantity*> quantities_;
  std::size_t people_;
  std::uint64_t facts_ = 0;
  std::optional<Journal> journal_;
  StudyProgress progress_;
  std::string first_reason_;
  std::int64_t next_design_ = 0;
  // Of the batch under way; keys by design and, within one, by person.
  std::vector<StudyRow> rows_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::size_t> missing_;  ///< cases, by design
};

/// Every other rank: does what it is given until rank 0 has no more.
void follow(const Study& study, Ranks& ranks, CaseEvaluation& evaluation,
            const std::atomic<bool>& stop) {
  const std::string facts = std::to_string(hash_of(study_facts(study)));
  for (;;) {
    const std::vector<std::string> message = unpacked(ranks.broadcast({}));
    if (message.size() < 2 || message[0] != "batch") return;
    const bool is_alike = message[1] == facts;
    ranks.share(
        message.size() - 2,
        [&](std::size_t task) {
          return is_alike ? evaluated(evaluation, StudyCase::of_bytes(message[task + 2]))
                          : kFailure + fmt::format(
                                           "rank {} has other files, another build or "
                                           "another instruction set than rank 0",
                                           ranks.rank());
        },
        {}, stop);
  }
}

}  // namespace

StudyHeadings headings_of(const Study& study) {
  StudyHeadings headings{.title = study.file.stem().string(),
                         .kind = std::string(row_of(kDesignKinds, study.plan.kind).name),
                         .device = study.device.written,
                         .device_text = study.device.text.text()};
  for (const Parameter& parameter : study.parameters) {
    headings.parameters.push_back({parameter.key, parameter.log, !parameter.is_free()});
  }
  for (std::size_t i = 0; const Quantity* quantity : study.quantities()) {
    headings.quantities.push_back({quantity->name,
                                   quantity->measure.empty() ? "formula" : quantity->measure,
                                   i++ < study.objectives.size(), quantity->maximise});
  }
  return headings;
}

StudySummary run_study(const Study& study, const StudyOptions& options, Ranks& ranks,
                       const std::atomic<bool>& stop, const StudyObserver& observer) {
  CaseEvaluation evaluation(study);
  if (ranks.rank() > 0) {
    follow(study, ranks, evaluation, stop);
    return {};
  }
  StudySummary summary;
  std::exception_ptr thrown;
  try {
    summary = Leader(study, options, ranks, evaluation, stop, observer).run();
  } catch (...) {
    thrown = std::current_exception();
  }
  ranks.broadcast(packed({"end"}));
  if (thrown) std::rethrow_exception(thrown);
  return summary;
}

std::string_view name_of(StudyEnd end) {
  switch (end) {
    case StudyEnd::kFinished:
      return "finished";
    case StudyEnd::kShardDone:
      return "shard done";
    case StudyEnd::kAwaitsOthers:
      return "awaits other shards";
    case StudyEnd::kStopped:
      break;
  }
  return "stopped";
}

}  // namespace softfinger
