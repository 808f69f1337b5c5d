#include "softfinger/session/report/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

Json in_ms(const Histogram& times) {
  if (times.count() == 0) return nullptr;
  return {{"p50", times.percentile(50.0) / ms},
          {"p99", times.percentile(99.0) / ms},
          {"max", times.max() / ms}};
}

/// Five a decade is enough to see by; empty ones are left out.
Json coarse(const Histogram& times) {
  constexpr int kTogether = 23;  // of Histogram's buckets
  Json result = Json::array();
  for (int first = 0; first < Histogram::kBuckets; first += kTogether) {
    const int last = std::min(first + kTogether, Histogram::kBuckets) - 1;
    std::uint64_t count = 0;
    for (int bucket = first; bucket <= last; ++bucket) count += times.bucket_count(bucket);
    if (count == 0) continue;
    const double edge = last == Histogram::kBuckets - 1 ? times.max() : Histogram::upper_edge(last);
    result.push_back({{"up_to_ms", edge / ms}, {"count", count}});
  }
  return result;
}

Json in_ms(const StageHistograms& stages) {
  Json result = Json::object();
  for (std::size_t i = 0; i < kLatencyStages; ++i) {
    Json& stage = result[std::string(kLatencyStageNames[i].name)] = in_ms(stages.all()[i]);
    if (!stage.is_null()) stage["histogram"] = coarse(stages.all()[i]);
  }
  return result;
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
          {"device_ticks", finger.ticks},
          {"force_limited_ticks", finger.force_limited_ticks},
          {"rate_limited_ticks", finger.rate_limited_ticks},
          {"max_contact_area_mm2", finger.max_contact_area / mm2},
          {"max_normal_force_N", finger.max_normal_force},
          {"max_normal_force_sum_N", finger.max_normal_force_sum},
          {"latency_ms", in_ms(finger.latency)},
          {"latency_stages_ms", in_ms(finger.stages)},
          {"pose_age_ms", in_ms(finger.pose_age)}};
}

std::string line(const char* what, const Histogram& times) {
  if (times.count() == 0) return "";
  return fmt::format("  {:<22} {:.3f} / {:.3f} / {:.3f} ms\n", what, times.percentile(50.0) / ms,
                     times.percentile(99.0) / ms, times.max() / ms);
}

}  // namespace

Json notices_json(const std::vector<DeviceNotice>& notices) {
  Json result = Json::array();
  for (const DeviceNotice& notice : notices) {
    result.push_back({{"key", notice.key}, {"text", notice.text}});
  }
  return result;
}

Json run_report(const RunSummary& summary) {
  Json misses = nullptr;
  if (summary.deadline_misses) misses = *summary.deadline_misses;
  Json result = report(summary.all, summary.steps, misses);
  result["recording"] = nullptr;
  if (summary.recording) {
    result["recording"] = summary.recording->string();
    result["dropped_rows"] = summary.dropped_rows;
  }
  if (!summary.objects.empty()) result["objects"] = Json::object();
  for (const ObjectSummary& object : summary.objects) {
    const Pose X_WO = object.last.X_WO.pose();
    const double joint = object.last.joint / unit_scale("_" + object.joint_unit);
    const auto numbers = [](const Vector3& v) { return Json{v.x(), v.y(), v.z()}; };
    result["objects"][object.name] = {
        {"position_mm", numbers(X_WO.translation / mm)},
        {"rotation_vector_deg", numbers(log_rotation(X_WO.rotation) / deg)},
        {"velocity_mm_per_s", numbers(object.last.velocity / mm)},
        {"joint", std::isnan(joint) ? Json(nullptr) : Json(joint)}};
  }
  result["fingers"] = Json::object();
  for (const auto& [name, finger] : summary.fingers) {
    Json& one = result["fingers"][name] = report(finger, summary.steps, misses);
    one["mount_shift_mm"] = std::round(finger.mount_shift / mm * 1e9) / 1e9;
    one["notices"] = notices_json(finger.notices);
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
  if (all.pose_age.max() > 0.0) text += line("pose, age when used", all.pose_age);
  text += line("pose to command", all.latency);
  for (std::size_t i = 0; i < kLatencyStages; ++i) {
    text += line(fmt::format("  {}", kLatencyStageNames[i].name).c_str(), all.stages.all()[i]);
  }
  text += fmt::format("  {:<22} {} / {} / {}\n", "iterations", all.iterations.percentile(50.0),
                      all.iterations.percentile(99.0), all.iterations.max());
  for (const auto& [name, finger] : summary.fingers) {
    text += fmt::format("  finger {}: at most {:.1f} mm2 in contact, {:.2f} N normal force\n", name,
                        finger.max_contact_area / mm2, finger.max_normal_force);
    if (finger.force_limited_ticks > 0) {
      text += fmt::format("    limits.max_force_N held its device back in {} of {} ticks\n",
                          finger.force_limited_ticks, finger.ticks);
    }
    if (finger.rate_limited_ticks > 0) {
      text += fmt::format(
          "    its device was still on its way, at its motors' rates, in {} of {} ticks\n",
          finger.rate_limited_ticks, finger.ticks);
    }
  }
  if (summary.recording) {
    text += fmt::format("  recorded in {}", summary.recording->string());
    if (summary.dropped_rows > 0) text += fmt::format(", {} rows missing", summary.dropped_rows);
    text += "\n";
  }
  return text;
}

}  // namespace softfinger
