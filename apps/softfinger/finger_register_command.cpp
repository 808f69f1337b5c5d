#include "finger_register_command.hpp"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/session/finger_registration.hpp"
#include "softfinger/session/report/registration_report.hpp"
#include "stop_signal.hpp"

namespace {

using namespace softfinger;

struct FingerRegisterFlags {
  std::string person, model, tracker, scene;
  std::string finger = "index";
  std::optional<double> length_mm, breadth_mm, depth_mm, table_mm;
  bool json = false;
};

std::optional<double> in_m(const std::optional<double>& length_mm) {
  return length_mm ? std::optional(*length_mm * mm) : std::nullopt;
}

void print_registration(const FingerRegisterFlags& flags, const FingerRegistration& registered) {
  const auto& [finger, found] = registered;
  fmt::print("{}: finger {}\n", flags.person, finger.name);
  const auto line = [](const char* name, const std::optional<double>& size) {
    if (size) fmt::print("  {} {:.1f} mm\n", name, *size / mm);
  };
  line("length", finger.size.length);
  line("breadth", finger.size.breadth);
  line("depth", finger.size.depth);
  if (!found) return;
  const Vector3 p = found->X_BodyFt.translation / mm;
  fmt::print(
      "  its centre lies at ({:.1f}, {:.1f}, {:.1f}) mm in the tracked body\n"
      "  postures fit within {:.1f} mm and {:.1f} degrees; the table is at {:.1f} mm\n",
      p.x(), p.y(), p.z(), found->height_residual / mm, found->turn_residual / deg,
      found->table_height / mm);
}

void register_finger_of(const FingerRegisterFlags& flags) {
  FingerRegistrationOptions options{
      .person = flags.person, .finger = flags.finger, .scene = flags.scene};
  options.measured = {.length = in_m(flags.length_mm),
                      .breadth = in_m(flags.breadth_mm),
                      .depth = in_m(flags.depth_mm)};
  options.tracker = flags.tracker;
  options.model = flags.model;
  options.table_height = in_m(flags.table_mm);
  ProgressBar bar;
  FingerRegistrationObserver observer;
  observer.ask = [&bar](const std::string& posture) {
    bar.clear();
    fmt::print(stderr, "{}\n", posture);
  };
  observer.message = [&bar](const std::string& message) {
    bar.clear();
    fmt::print(stderr, "softfinger: {}\n", message);
  };
  observer.progress = [&bar](double part, std::optional<double> end) {
    bar.show(part / end.value_or(1.0));
  };
  const FingerRegistration registered = register_one(options, stop_on_signals(), observer);
  bar.clear();
  if (flags.json) {
    fmt::print("{}\n", registration_report(flags.person, registered).dump(2));
  } else {
    print_registration(flags, registered);
  }
}

}  // namespace

void add_finger_register_command(CLI::App& finger) {
  CLI::App* command = finger.add_subcommand(
      "register", "Find a person's finger size, and where the tracked body sits on the finger");
  auto flags = std::make_shared<FingerRegisterFlags>();
  command->add_option("--person", flags->person, "person file to write or change")->required();
  command->add_option("--finger", flags->finger, "whose tables are written")->capture_default_str();
  takes_shipped(command->add_option("--scene", flags->scene,
                                    "scene whose finger it is, where its name is none of a hand's"),
                Shipped::kScene);
  command->add_option("--length-mm", flags->length_mm, "of the fingertip, measured");
  command->add_option("--breadth-mm", flags->breadth_mm, "of the fingertip, measured");
  command->add_option("--depth-mm", flags->depth_mm, "of the fingertip, measured");
  command->add_option("--tracker", flags->tracker,
                      fmt::format("of the body on the finger: {}; guides through five postures on "
                                  "a table",
                                  registering_trackers()));
  takes_shipped(command->add_option("--model", flags->model, "finger file whose shape is fitted"),
                Shipped::kFinger);
  command->add_option("--table-mm", flags->table_mm,
                      "height of the table in the world; without sizes, the finger's is found");
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { register_finger_of(*flags); });
}
