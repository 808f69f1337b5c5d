#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/report/run_report.hpp"

namespace softfinger {
namespace {

constexpr int kMostThreads = 64;

RunOptions run_options(const char* scene, const sf_run_options& given) {
  RunOptions run;
  run.scene = scene;
  run.as_fast_as_possible = true;
  run.actuator.port = "emulator";
  if (given.device != nullptr) run.devices.emplace_back(given.device);
  if (given.tracker != nullptr) run.trackers.emplace_back(given.tracker);
  if (given.wearer != nullptr) run.wearer = given.wearer;
  if (given.person != nullptr) run.person = given.person;
  if (given.recording != nullptr) {
    run.recording = given.recording;
    refuse_unless_recordable(*run.recording);
  }
  run.record_state = given.record_state != 0;
  if (run.record_state && !run.recording) throw InputError("record_state: needs recording");
  if (given.filter != 0) run.conditioning.filter.emplace();
  if (given.predict_s != 0.0) {
    if (!(given.predict_s > 0.0 && given.predict_s <= PoseConditioning::kMostLead)) {
      throw InputError("predict_s: must be a time of 0 to " +
                       std::to_string(PoseConditioning::kMostLead) + " in seconds");
    }
    run.conditioning.lead = given.predict_s;
  }
  if (given.threads < 0 || given.threads > kMostThreads) {
    throw InputError("threads: must be 1 to " + std::to_string(kMostThreads) + ", or 0 for one");
  }
  if (given.threads > 0) run.threads = given.threads;
  run.duration = duration_of(given.duration_s);
  return run;
}

}  // namespace
}  // namespace softfinger

sf_status sf_run(const char* scene, const sf_run_options* options, sf_table** out, char* error,
                 size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (scene == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "scene and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const sf_run_options given =
        softfinger::taken(options, offsetof(sf_run_options, tracker), "sf_run_options");
    const softfinger::RunOptions how = softfinger::run_options(scene, given);
    const softfinger::HostWatch host(given.stop, given.progress);
    const softfinger::RunSummary summary =
        softfinger::run_headless(how, host.stop(), host.observer());
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::run_report(summary).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
