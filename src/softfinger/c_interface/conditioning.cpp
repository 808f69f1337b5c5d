#include <memory>
#include <utility>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/session/report/conditioning_report.hpp"

namespace softfinger {
namespace {

ConditioningQuestion question_of(const char* motion, const sf_condition_options& given) {
  ConditioningQuestion question{.motion = motion, .finger = text_or_empty(given.finger)};
  if (given.rate_Hz != 0.0) question.quality.rate = given.rate_Hz;
  question.quality.age = given.age_s;
  question.quality.noise = given.noise_m;
  question.quality.turn_noise = given.noise_rad;
  question.filter = given.filter != 0;
  if (given.predict != 0) question.predict = given.predict_s;
  return question;
}

}  // namespace
}  // namespace softfinger

sf_status sf_condition(const char* motion, const sf_condition_options* options, sf_table** out,
                       char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (motion == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "motion and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const auto question = softfinger::question_of(
        motion, softfinger::taken(options, sizeof(sf_condition_options), "sf_condition_options"));
    auto table = std::make_unique<softfinger::Table>();
    table->text =
        softfinger::conditioning_report(softfinger::conditioning_effect(question)).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
