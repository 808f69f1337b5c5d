#include "softfinger/session/finger_registration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/tracking/hand_part.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

constexpr double kPoseInterval = 5e-3;  // s

void check_size(const char* flag, const std::optional<double>& size) {
  if (!size || (*size >= FingerSize::kLeast && *size <= FingerSize::kGreatest)) return;
  throw InputError(fmt::format("{} {:g}: must be {} to {} mm", flag, *size / mm,
                               FingerSize::kLeast / mm, FingerSize::kGreatest / mm));
}

/// Of a scene file, whose other content does not matter here; never where none is named.
bool is_finger_of(const std::filesystem::path& scene, const std::string& name) {
  if (scene.empty()) return false;
  const ConfigFile file(scene);
  return std::ranges::any_of(file.root().tables("finger"), [&](const ConfigTable& finger) {
    return finger.text("name") == name;
  });
}

void check_name(const FingerRegistrationOptions& options) {
  if (!is_finger_name(options.finger)) {
    throw InputError(
        fmt::format("--finger '{}': expected 1 to 64 letters, digits, - or _", options.finger));
  }
  if (hand_finger_of(options.finger) || is_finger_of(options.scene, options.finger)) return;
  throw InputError(
      options.scene.empty()
          ? fmt::format("--finger '{}': expected thumb, index, middle, ring or pinky, or a finger "
                        "of a scene given by --scene; runs refuse any other",
                        options.finger)
          : fmt::format("--finger '{}': neither a finger of a hand (thumb, index, middle, ring, "
                        "pinky) nor of {}",
                        options.finger, options.scene.string()));
}

RegistrationTask task_of(const FingerRegistrationOptions& options) {
  check_name(options);
  check_size("--length-mm", options.measured.length);
  check_size("--breadth-mm", options.measured.breadth);
  check_size("--depth-mm", options.measured.depth);
  if (options.table_height) {
    constexpr double kHighest = RegistrationTask::kHighestTable;
    if (!(std::abs(*options.table_height) <= kHighest)) {
      throw InputError(fmt::format("--table-mm {:g}: must be {} to {} mm",
                                   *options.table_height / mm, -kHighest / mm, kHighest / mm));
    }
  }
  if (options.tracker.empty()) {
    if (options.table_height) throw InputError("--table-mm: needs --tracker SPEC");
    const FingerSize& size = options.measured;
    if (!size.length && !size.breadth && !size.depth) {
      throw InputError(
          "finger register: give --tracker SPEC, or sizes by --length-mm, --breadth-mm, "
          "--depth-mm");
    }
  } else if (options.model.empty()) {
    throw InputError("--tracker: needs --model FINGER, the finger file whose shape is fitted");
  }
  return {.finger = options.finger,
          .model = options.model,
          .measured = options.measured,
          .table_height = options.table_height};
}

/// Time of the tracker: a file's own where it comes from one, else the wall's.
class TrackerTime {
 public:
  explicit TrackerTime(bool simulated) : simulated_(simulated) {}
  [[nodiscard]] double next() {
    if (simulated_) return kPoseInterval * static_cast<double>(count_++);
    std::this_thread::sleep_for(std::chrono::duration<double>(kPoseInterval));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  bool simulated_;
  int count_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Whether its body can be registered without a page.
bool is_registered_here(const TrackerRow& tracker) {
  return tracker.of_body && tracker.origin != PoseOrigin::kPage;
}

RegistrationProcedure guide(const std::string& spec, const std::atomic<bool>& stop,
                            const FingerRegistrationObserver& observer) {
  const TrackerKind kind = parse_tracker_spec(spec).kind;
  if (!is_registered_here(row_of(kTrackers, kind))) {
    throw InputError(
        fmt::format("--tracker {}: expected {}; a page or a headset registers on the live page of "
                    "run --person",
                    spec, registering_trackers()));
  }
  const auto tracker = make_tracker(spec, {}, {});
  TrackerTime clock(kind == TrackerKind::kCsv);
  RegistrationProcedure procedure;
  std::optional<std::size_t> told;
  constexpr auto kPostureCount = static_cast<double>(RegistrationProcedure::kOrder.size());
  while (!procedure.done()) {
    const std::size_t held = procedure.captures().size();
    if (told != held) {
      told = held;
      if (observer.ask) {
        observer.ask(fmt::format("{} of {}: {}, and hold still", held + 1,
                                 RegistrationProcedure::kOrder.size(),
                                 row_of(kPostures, procedure.wanted()).words));
      }
    }
    const double time = clock.next();
    if (tracker->end_time() && time > *tracker->end_time() + kPoseInterval) {
      throw InputError(
          fmt::format("--tracker {}: ends before posture '{}' was held still for a second", spec,
                      name_of(procedure.wanted())));
    }
    if (stop) throw OperationError("finger register: stopped; nothing was written");
    procedure.take(tracker->sample(time));
    if (observer.progress) {
      observer.progress(static_cast<double>(held) + procedure.progress(), kPostureCount);
    }
    while (const auto message = tracker->take_message()) {
      if (observer.message) observer.message(*message);
    }
  }
  return procedure;
}

}  // namespace

std::string registering_trackers(std::string_view last) {
  return trackers_in_brief(last, is_registered_here);
}

FingerRegistration register_one(const FingerRegistrationOptions& options,
                                const std::atomic<bool>& stop,
                                const FingerRegistrationObserver& observer) {
  const RegistrationTask task = task_of(options);
  // Before anybody lays a finger anywhere.
  Person person = load_person_if_any(options.person);
  std::optional<Registration> found;
  if (options.tracker.empty()) {
    PersonFinger& finger = person.at(task.finger);
    finger.size = completed(task.measured, finger.size);
  } else {
    (void)FingerModel::load(task.model);
    const RegistrationProcedure procedure = guide(options.tracker, stop, observer);
    found = register_person(person, task, procedure.captures());
  }
  save_person(person);
  return {.finger = *person.find(task.finger), .found = found};
}

}  // namespace softfinger
