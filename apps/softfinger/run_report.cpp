#include "run_report.hpp"

#include <fmt/format.h>

#include "softfinger/base/units.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

Json in_ms(const Histogram& times) {
  if (times.count() == 0) return nullptr;
  return {{"p50", times.percentile(50.0) / ms},
          {"p99", times.percentile(99.0) / ms},
          {"max", times.max() / ms}};
}

Json report(const FingerSummary& finger, std::int64_t steps, const Json& deadline_misses) {
  return {{"steps", steps},
          {"step_ms", in_ms(finger.step_cpu_time)},
          {"match_ms", in_ms(finger.match_cpu_time)},
          {"step_wall_ms", in_ms(finger.step_wall_time)},
          {"deadline_misses", deadline_misses},
          {"iterations",
           {{"p50", finger.iterations.percentile(50.0)},
            {"p99", finger.iterations.percentile(99.0)},
            {"max", finger.iterations.max()}}},
          {"unconverged_steps", finger.unconverged_steps},
          {"commands_sent", finger.commands_sent},
          {"max_contact_area_mm2", finger.max_contact_area / mm2},
          {"max_normal_force_N", finger.max_normal_force},
          {"latency_ms", in_ms(finger.latency)},
          {"pose_age_ms", in_ms(finger.pose_age)}};
}

std::string line(const char* what, const Histogram& times) {
  if (times.count() == 0) return "";
  return fmt::format("  {:<22} {:.3f} / {:.3f} / {:.3f} ms\n", what, times.percentile(50.0) / ms,
                     times.percentile(99.0) / ms, times.max() / ms);
}

}  // namespace

Json run_report(const RunSummary& summary) {
  Json misses = nullptr;
  if (summary.deadline_misses) misses = *summary.deadline_misses;
  Json result = report(summary.all, summary.steps, misses);
  result["recording"] = nullptr;
  if (summary.recording) {
    result["recording"] = summary.recording->string();
    result["dropped_rows"] = summary.dropped_rows;
  }
  result["fingers"] = Json::object();
  for (const auto& [name, finger] : summary.fingers) {
    result["fingers"][name] = report(finger, summary.steps, misses);
  }
  return result;
}

std::string run_report_text(const RunSummary& summary) {
  const FingerSummary& all = summary.all;
  std::string text =
      fmt::format("{} steps, {} not converged", summary.steps, all.unconverged_steps);
  if (summary.deadline_misses) text += fmt::format(", {} late", *summary.deadline_misses);
  text += fmt::format("; {} commands sent\n", all.commands_sent);
  text += "  median / 99 % / most:\n";
  text += line("step, CPU time", all.step_cpu_time);
  text += line("step, wall time", all.step_wall_time);
  text += line("match, CPU time", all.match_cpu_time);
  text += line("pose to command", all.latency);
  text += fmt::format("  {:<22} {} / {} / {}\n", "iterations", all.iterations.percentile(50.0),
                      all.iterations.percentile(99.0), all.iterations.max());
  for (const auto& [name, finger] : summary.fingers) {
    text += fmt::format("  finger {}: at most {:.1f} mm2 in contact, {:.2f} N normal force\n", name,
                        finger.max_contact_area / mm2, finger.max_normal_force);
  }
  if (summary.recording) {
    text += fmt::format("  recorded in {}", summary.recording->string());
    if (summary.dropped_rows > 0) text += fmt::format(", {} rows missing", summary.dropped_rows);
    text += "\n";
  }
  return text;
}
