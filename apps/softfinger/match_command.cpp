#include <fmt/core.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "contact_points_file.hpp"
#include "device_json.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/objectives/first_touch_match.hpp"

namespace {

using namespace softfinger;

struct MatchFlags {
  std::string device, points, objective = "surface", limits, separation, weights = "uniform";
  bool json = false;
};

MatchingOptions matching_options(const MatchFlags& flags, const ContactPointsFile& points) {
  static const std::map<std::string, MatchingLimits> kLimits{{"inside", MatchingLimits::kInside},
                                                             {"clamp", MatchingLimits::kClamp},
                                                             {"none", MatchingLimits::kNone}};
  MatchingOptions options;
  const bool as_published = flags.objective == "published";
  options.limits = kLimits.at(!flags.limits.empty() ? flags.limits
                              : as_published        ? "clamp"
                                                    : "inside");
  const bool has_gaps = !points.gaps.empty();
  // As published it is refused whatever the points have, see first_touch_match().
  if (flags.separation == "scene" && !has_gaps && !as_published) {
    throw InputError("match: --separation scene needs distance_mm in " + flags.points);
  }
  const bool constant =
      flags.separation.empty() ? as_published || !has_gaps : flags.separation == "constant";
  options.separation = constant ? Separation::kConstant : Separation::kScene;
  if (flags.weights == "area") {
    if (points.areas.empty()) {
      throw InputError("match: --weights area needs area_mm2 in " + flags.points);
    }
    options.weights = MatchingWeights::kArea;
  }
  options.separation_tolerance = points.separation_tolerance;
  return options;
}

void match(const MatchFlags& flags) {
  const auto device = load_device(flags.device);
  const ContactPointsFile points = read_contact_points(flags.points);
  const MatchingOptions options = matching_options(flags, points);
  ContactSurfaceMatching matching(device, static_cast<int>(points.points_F.size()));
  const MatchingResult result = first_touch_match(
      *objective_kind(flags.objective), device,
      {points.points_F, points.in_contact, points.areas, points.gaps}, options, matching);
  nlohmann::ordered_json answer{
      {"configuration", configuration_json(*device, result.configuration)}};
  add_joints(answer, *device, result.joints_exist ? &result.joints : nullptr);
  answer["deviation_mm2"] = result.deviation / mm2;
  answer["iterations"] = result.iterations;
  answer["termination"] = std::string(to_string(result.termination));
  answer["at_limit"] = matching.limit_names(result);
  if (flags.json) {
    fmt::print("{}\n", answer.dump());
    return;
  }
  for (const auto& [name, value] : answer["configuration"].items()) {
    fmt::print("{:<16} {:.4f}\n", name, value.get<double>());
  }
  const char* joints = answer.contains("joints_mm") ? "joints_mm" : "joints_deg";
  fmt::print("{:<16} {}\n", joints, answer[joints].dump());
  fmt::print("{:<16} {:.6g}\n", "deviation_mm2", result.deviation / mm2);
  fmt::print("{} after {} iterations{}\n", to_string(result.termination), result.iterations,
             answer["at_limit"].empty() ? "" : "; at limit: " + answer["at_limit"].dump());
}

}  // namespace

void add_match_command(CLI::App& app) {
  auto flags = std::make_shared<MatchFlags>();
  CLI::App* command =
      app.add_subcommand("match", "Device configuration that touches the given skin samples");
  takes_shipped(command->add_option("DEVICE", flags->device,
                                    "Device file (TOML), or the name of a shipped one"),
                Shipped::kDevice)
      ->required();
  command->add_option("--points", flags->points, "Points file (JSON)")->required();
  command
      ->add_option("--objective", flags->objective,
                   "surface (default), published (Levenberg-Marquardt from home) or plane")
      ->check(CLI::IsMember({"published", "plane", "surface", "contact_plane"}));
  command
      ->add_option("--limits", flags->limits,
                   "How limits enter: inside (default), clamp (of published the default) or none")
      ->check(CLI::IsMember({"inside", "clamp", "none"}));
  command
      ->add_option("--separation", flags->separation,
                   "constant or scene (default: scene where the file has distances)")
      ->check(CLI::IsMember({"constant", "scene"}));
  command->add_option("--weights", flags->weights, "uniform or area")
      ->check(CLI::IsMember({"uniform", "area"}));
  command->add_flag("--json", flags->json, "One JSON object");
  command->callback([flags] {
    flags->objective = present_objective(flags->objective);
    match(*flags);
  });
}
