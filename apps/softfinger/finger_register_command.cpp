#include "finger_register_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "progress_bar.hpp"
#include "rounded.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/tracking/hand_part.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "stop_signal.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

constexpr double kPollInterval = 5e-3;  // s

struct FingerRegisterFlags {
  std::string person, model, tracker, scene;
  std::string finger = "index";
  std::optional<double> length_mm, breadth_mm, depth_mm, table_mm;
  bool json = false;
};

std::optional<double> size_of(const char* flag, std::optional<double> size_mm) {
  if (!size_mm) return std::nullopt;
  if (!(*size_mm * mm >= FingerSize::kLeast && *size_mm * mm <= FingerSize::kGreatest)) {
    throw InputError(fmt::format("{} {}: must be {} to {} mm", flag, *size_mm,
                                 FingerSize::kLeast / mm, FingerSize::kGreatest / mm));
  }
  return *size_mm * mm;
}

/// Of a scene file, whose other content does not matter here; never where none is named.
bool is_finger_of(const std::string& scene, const std::string& name) {
  if (scene.empty()) return false;
  const ConfigFile file(scene);
  return std::ranges::any_of(file.root().tables("finger"), [&](const ConfigTable& finger) {
    return finger.text("name") == name;
  });
}

RegistrationTask task_of(const FingerRegisterFlags& flags) {
  if (!is_finger_name(flags.finger)) {
    throw InputError(
        fmt::format("--finger '{}': expected 1 to 64 letters, digits, - or _", flags.finger));
  }
  if (!hand_finger_of(flags.finger) && !is_finger_of(flags.scene, flags.finger)) {
    throw InputError(
        flags.scene.empty()
            ? fmt::format(
                  "--finger '{}': expected thumb, index, middle, ring or pinky, or a finger "
                  "of a scene given by --scene; runs refuse any other",
                  flags.finger)
            : fmt::format("--finger '{}': neither a finger of a hand (thumb, index, middle, ring, "
                          "pinky) nor of {}",
                          flags.finger, flags.scene));
  }
  RegistrationTask task;
  task.finger = flags.finger;
  task.model = flags.model;
  task.measured = {.length = size_of("--length-mm", flags.length_mm),
                   .breadth = size_of("--breadth-mm", flags.breadth_mm),
                   .depth = size_of("--depth-mm", flags.depth_mm)};
  if (flags.table_mm) {
    constexpr double kHighest = RegistrationTask::kHighestTable;
    if (!(std::abs(*flags.table_mm * mm) <= kHighest)) {
      throw InputError(fmt::format("--table-mm {}: must be {} to {} mm", *flags.table_mm,
                                   -kHighest / mm, kHighest / mm));
    }
    task.table_height = *flags.table_mm * mm;
  }
  if (flags.tracker.empty()) {
    if (flags.table_mm) throw InputError("--table-mm: needs --tracker SPEC");
    if (!flags.length_mm && !flags.breadth_mm && !flags.depth_mm) {
      throw InputError(
          "finger register: give --tracker SPEC, or sizes by --length-mm, --breadth-mm, "
          "--depth-mm");
    }
  } else if (flags.model.empty()) {
    throw InputError("--tracker: needs --model FINGER, the finger file whose shape is fitted");
  }
  return task;
}

/// Time of the tracker: a file's own where it comes from one, else the wall's.
class TrackerTime {
 public:
  explicit TrackerTime(bool simulated) : simulated_(simulated) {}
  [[nodiscard]] double next() {
    if (simulated_) return kPollInterval * static_cast<double>(count_++);
    std::this_thread::sleep_for(std::chrono::duration<double>(kPollInterval));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  bool simulated_;
  int count_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Whether its body can be registered on the terminal.
bool is_registered_here(const TrackerRow& tracker) {
  return tracker.of_body && tracker.origin != PoseOrigin::kPage;
}

RegistrationProcedure guide(const std::string& spec) {
  const TrackerKind kind = parse_tracker_spec(spec).kind;
  if (!is_registered_here(row_of(kTrackers, kind))) {
    throw InputError(
        fmt::format("--tracker {}: expected {}; a page or a headset registers on the live page of "
                    "run --person",
                    spec, trackers_in_brief("or", is_registered_here)));
  }
  const auto tracker = make_tracker(spec, {}, {});
  const std::atomic<bool>& stop = stop_on_signals();
  TrackerTime clock(kind == TrackerKind::kCsv);
  RegistrationProcedure procedure;
  ProgressBar bar;
  std::optional<std::size_t> told;
  while (!procedure.done()) {
    const std::size_t held = procedure.captures().size();
    if (told != held) {
      told = held;
      bar.clear();
      fmt::print(stderr, "{} of {}: {}, and hold still\n", held + 1,
                 RegistrationProcedure::kOrder.size(), row_of(kPostures, procedure.wanted()).words);
    }
    const double time = clock.next();
    if (tracker->end_time() && time > *tracker->end_time() + kPollInterval) {
      throw InputError(
          fmt::format("--tracker {}: ends before posture '{}' was held still for a second", spec,
                      name_of(procedure.wanted())));
    }
    if (stop) throw OperationError("finger register: stopped; nothing was written");
    procedure.take(tracker->sample(time));
    bar.show(procedure.progress());
    while (const auto message = tracker->take_message()) {
      bar.clear();
      fmt::print(stderr, "softfinger: {}\n", *message);
    }
  }
  bar.clear();
  return procedure;
}

Json in_unit(const Vector3& vector, double unit) {
  return {micro_rounded(vector.x() / unit), micro_rounded(vector.y() / unit),
          micro_rounded(vector.z() / unit)};
}

Json size_json(const std::optional<double>& size) {
  return size ? Json(micro_rounded(*size / mm)) : Json(nullptr);
}

void print_registration(const FingerRegisterFlags& flags, const PersonFinger& finger,
                        const std::optional<Registration>& found) {
  if (flags.json) {
    Json report{{"person", flags.person},
                {"finger", finger.name},
                {"length_mm", size_json(finger.size.length)},
                {"breadth_mm", size_json(finger.size.breadth)},
                {"depth_mm", size_json(finger.size.depth)},
                {"translation_mm", nullptr},
                {"rotation_vector_deg", nullptr},
                {"table_height_mm", nullptr},
                {"height_residual_mm", nullptr},
                {"turn_residual_deg", nullptr}};
    if (found) {
      report["translation_mm"] = in_unit(found->X_BodyFt.translation, mm);
      report["rotation_vector_deg"] = in_unit(log_rotation(found->X_BodyFt.rotation), deg);
      report["table_height_mm"] = micro_rounded(found->table_height / mm);
      report["height_residual_mm"] = micro_rounded(found->height_residual / mm);
      report["turn_residual_deg"] = micro_rounded(found->turn_residual / deg);
    }
    fmt::print("{}\n", report.dump(2));
    return;
  }
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

void register_one(const FingerRegisterFlags& flags) {
  const RegistrationTask task = task_of(flags);
  // Before anybody lays a finger anywhere.
  Person person = load_person_if_any(flags.person);
  std::optional<Registration> found;
  if (flags.tracker.empty()) {
    PersonFinger& finger = person.at(task.finger);
    finger.size = completed(task.measured, finger.size);
  } else {
    (void)FingerModel::load(task.model);
    const RegistrationProcedure procedure = guide(flags.tracker);
    found = register_person(person, task, procedure.captures());
  }
  save_person(person);
  print_registration(flags, *person.find(task.finger), found);
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
                                  trackers_in_brief("or", is_registered_here)));
  takes_shipped(command->add_option("--model", flags->model, "finger file whose shape is fitted"),
                Shipped::kFinger);
  command->add_option("--table-mm", flags->table_mm,
                      "height of the table in the world; without sizes, the finger's is found");
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { register_one(*flags); });
}
