#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/scene/scene.hpp"
#include "softfinger/session/virtual_side.hpp"
#include "softfinger/study/case.hpp"
#include "softfinger/study/study.hpp"

namespace softfinger {

/// Evaluates cases of a study: for the same case always the same outcome. What does not hang on the
/// device, the virtual side of each scene and person, is kept for the cases that follow, the last
/// ones used, within `most_bytes` of memory. One thread.
class CaseEvaluation {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{384} << 20;

  /// `study` must outlive it.
  explicit CaseEvaluation(const Study& study, std::size_t most_bytes = kMostBytes);

  /// A design that cannot be built or worn has the reader's reason.
  [[nodiscard]] CaseOutcome evaluate(const StudyCase& one);
  /// How many virtual sides were run so far.
  [[nodiscard]] std::size_t virtual_runs() const { return virtual_runs_; }

 private:
  /// What was read or run with these texts, newest first.
  template <typename T>
  using Kept = std::list<std::pair<std::string, T>>;

  [[nodiscard]] CaseOutcome evaluate_or_throw(const StudyCase& one);
  [[nodiscard]] std::string text_of(VariedFile file, const StudyFile& base,
                                    const Design& design) const;
  std::shared_ptr<const FingerModel> finger(const std::string& text, std::size_t person);
  std::shared_ptr<const Scene> scene(const StudyFile& file, const std::string& text);
  std::shared_ptr<const VirtualSide> side(const StudyFile& file, const std::string& scene_text,
                                          const std::shared_ptr<const FingerModel>& model,
                                          const std::string& model_name, double device_rate);
  [[nodiscard]] Evaluation judged(const VirtualSide& side, JudgedDevice& device) const;
  void forget_oldest_sides();

  const Study& study_;
  std::size_t most_bytes_;
  std::vector<PersonFactors> people_;
  std::vector<std::string> measures_;
  JudgedSides sides_needed_;
  Kept<std::shared_ptr<const FingerModel>> fingers_;
  Kept<std::shared_ptr<const Scene>> scenes_;
  Kept<std::shared_ptr<const VirtualSide>> sides_;
  std::size_t virtual_runs_ = 0;
};

}  // namespace softfinger
