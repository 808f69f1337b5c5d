#include "softfinger/study/case_evaluation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/loop/device_clock.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMostFingers = 256;
constexpr std::size_t kMostScenes = 8;
/// Of max_force_N: while neither side bears more, the ceiling of force, which takes seconds to
/// make, holds nothing back and is left out.
constexpr double kCeilingMatters = 0.5;

/// What is kept under this name, now the newest; null: nothing.
template <typename T>
const T* found(std::list<std::pair<std::string, T>>& kept, const std::string& name) {
  const auto at = std::ranges::find(kept, name, &std::pair<std::string, T>::first);
  if (at == kept.end()) return nullptr;
  kept.splice(kept.begin(), kept, at);
  return &kept.front().second;
}

template <typename T>
const T& keep(std::list<std::pair<std::string, T>>& kept, const std::string& name, T value,
              std::size_t most) {
  kept.emplace_front(name, std::move(value));
  while (kept.size() > most) kept.pop_back();
  return kept.front().second;
}

/// The reader's words, with files as the study calls them: a reason is the same wherever it lies.
std::string as_written(std::string words, const StudyFile& file) {
  const std::string path = file.path.string();
  for (std::size_t at = 0; (at = words.find(path, at)) != std::string::npos;
       at += file.written.size()) {
    words.replace(at, path.size(), file.written);
  }
  return words;
}

double greatest_force(const Evaluation& evaluation) {
  double greatest = 0.0;
  for (const EvaluatedFrame& frame : evaluation.frames) {
    greatest = std::max({greatest, frame.virtual_force_sum, frame.twin_force_sum});
  }
  return greatest;
}

}  // namespace

CaseEvaluation::CaseEvaluation(const Study& study, std::size_t most_bytes)
    : study_(study),
      most_bytes_(most_bytes),
      people_(draw_people(study.population)),
      measures_(study.measures()),
      sides_needed_(sides_for(measures_)) {}

CaseOutcome CaseEvaluation::evaluate(const StudyCase& one) {
  try {
    return evaluate_or_throw(one);
  } catch (const InputError& error) {
    std::string reason = as_written(error.what(), study_.device);
    if (study_.finger) reason = as_written(std::move(reason), *study_.finger);
    for (const StudyFile& scene : study_.scenes) reason = as_written(std::move(reason), scene);
    return {.reason = std::move(reason), .values = {}};
  }
}

CaseOutcome CaseEvaluation::evaluate_or_throw(const StudyCase& one) {
  for (std::size_t i = 0; i < one.design.size(); ++i) {
    if (!std::isfinite(one.design[i])) {
      throw InputError(
          fmt::format("{}: the formula it is tied by has no value here", study_.parameters[i].key));
    }
  }
  const std::string device_text = text_of(VariedFile::kDevice, study_.device, one.design);
  CaseOutcome outcome;
  outcome.values.reserve(measures_.size());
  if (study_.scenes.empty()) {
    static_cast<void>(load_device(study_.device.path, device_text, 0.0));
    return outcome;
  }
  const std::string finger_text = text_of(VariedFile::kFinger, *study_.finger, one.design);
  const auto wearer = finger(finger_text, one.person);
  const bool is_own = study_.population.fitted;
  const auto model = is_own ? wearer : finger(finger_text, people_.size());
  const std::string model_name =
      fmt::format("{} {}", is_own ? one.person : people_.size(), finger_text);
  JudgedDevice device{.worn = worn_on(*model, study_.device.path, device_text),
                      .file = study_.device.path,
                      .wearer = wearer == model ? nullptr : wearer,
                      .objective = study_.objective,
                      .sides = sides_needed_};
  if (study_.objective != nullptr) {
    const std::string why = why_not(*study_.objective, *device.worn.device);
    if (!why.empty()) {
      throw InputError(fmt::format("{}: objective: {}", study_.file.filename().string(), why));
    }
  }
  if (measures_.empty()) return outcome;  // formulas alone
  std::vector<std::vector<double>> values(measures_.size());
  for (const StudyFile& file : study_.scenes) {
    const std::string scene_text = text_of(VariedFile::kScene, file, one.design);
    const auto virtual_side =
        side(file, scene_text, model, model_name, device_rate(*device.worn.device));
    const Evaluation evaluation = judged(*virtual_side, device);
    for (std::size_t i = 0; i < measures_.size(); ++i) {
      const std::vector<double> more = measured(evaluation, measures_[i]);
      values[i].insert(values[i].end(), more.begin(), more.end());
    }
  }
  std::size_t next = 0;
  for (const Quantity* quantity : study_.quantities()) {
    if (quantity->measure.empty()) continue;
    outcome.values.push_back(
        over(std::move(values[next++]), quantity->over_frames, quantity->maximise));
  }
  return outcome;
}

std::string CaseEvaluation::text_of(VariedFile file, const StudyFile& base,
                                    const Design& design) const {
  std::vector<std::pair<std::string, double>> numbers;
  for (std::size_t i = 0; i < design.size(); ++i) {
    const Parameter& parameter = study_.parameters[i];
    if (parameter.file == file) numbers.emplace_back(parameter.way, design[i]);
  }
  return base.text.with(numbers);
}

std::shared_ptr<const FingerModel> CaseEvaluation::finger(const std::string& text,
                                                          std::size_t person) {
  const std::string name = fmt::format("{} {}", person, text);
  if (const auto* kept = found(fingers_, name)) return *kept;
  if (person == people_.size()) {
    return keep(fingers_, name, FingerModel::load(study_.finger->path, text), kMostFingers);
  }
  const auto nominal = finger(text, people_.size());
  return keep(fingers_, name, finger_of(nominal, people_[person], text), kMostFingers);
}

std::shared_ptr<const Scene> CaseEvaluation::scene(const StudyFile& file, const std::string& text) {
  const std::string name = fmt::format("{} {}", file.path.string(), text);
  if (const auto* kept = found(scenes_, name)) return *kept;
  return keep(scenes_, name,
              std::shared_ptr<const Scene>(std::make_shared<Scene>(load_scene(file.path, text))),
              kMostScenes);
}

std::shared_ptr<const VirtualSide> CaseEvaluation::side(
    const StudyFile& file, const std::string& scene_text,
    const std::shared_ptr<const FingerModel>& model, const std::string& model_name,
    double device_rate) {
  const std::string name =
      fmt::format("{} {} {} {}", device_rate, file.path.string(), scene_text, model_name);
  if (const auto* kept = found(sides_, name)) return *kept;
  ++virtual_runs_;
  auto made = std::make_shared<const VirtualSide>(
      run_virtual_side(*scene(file, scene_text), model, device_rate));
  sides_.emplace_front(name, made);
  forget_oldest_sides();
  return made;
}

void CaseEvaluation::forget_oldest_sides() {
  std::size_t bytes = 0;
  for (auto at = sides_.begin(); at != sides_.end();) {
    bytes += at->second->bytes();
    at = at != sides_.begin() && bytes > most_bytes_ ? sides_.erase(at) : std::next(at);
  }
}

Evaluation CaseEvaluation::judged(const VirtualSide& side, JudgedDevice& device) const {
  const double max_force = device.worn.device->settings().max_force;
  Evaluation evaluation = judge_on(side, device);
  if (device.worn.ceiling || !(max_force > 0.0) ||
      greatest_force(evaluation) <= kCeilingMatters * max_force) {
    return evaluation;
  }
  device.worn.ceiling = ceiling_on(*side.model, device.file, device.worn.device);
  return judge_on(side, device);
}

}  // namespace softfinger
