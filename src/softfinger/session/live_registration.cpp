#include "softfinger/session/live_registration.hpp"

#include <fmt/core.h>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {

using Phase = RegistrationState::Phase;

bool LiveRegistration::begin(const LiveRequest& request, const RunSetup& setup,
                             std::uint64_t generation) {
  if (!is_registrable(setup, request.finger)) return false;
  person_ = setup.person->file;
  const SceneFinger& finger = setup.scene.fingers[request.finger];
  generation_ = generation;
  task_ = {.finger = finger.name,
           .model = finger.model,
           .measured = request.measured,
           .table_height = request.table_height};
  X_FtBody_ = setup.registrations[request.finger].value_or(Pose{}).inverse();
  procedure_ = {};
  state_ = {.phase = Phase::kRunning,
            .finger = request.finger,
            .postures = RegistrationProcedure::kOrder.size()};
  tell_wanted();
  return true;
}

void LiveRegistration::tell_wanted() {
  const PostureRow& posture = row_of(kPostures, procedure_.wanted());
  state_.wanted = posture.name;
  state_.words = posture.sentence;
}

void LiveRegistration::cancel() { state_ = {}; }

bool LiveRegistration::take(const Snapshot& snapshot) {
  if (state_.phase != Phase::kRunning) return false;
  if (snapshot.generation != generation_) {
    cancel();
    return false;
  }
  const Snapshot::Finger& finger = snapshot.fingers[state_.finger];
  procedure_.take(
      {.time = finger.tracked_time, .X_WFt = finger.X_WFt * X_FtBody_, .valid = finger.tracked});
  if (procedure_.done()) return conclude();
  state_.held = procedure_.captures().size();
  tell_wanted();
  state_.progress = procedure_.progress();
  return false;
}

bool LiveRegistration::conclude() {
  state_.held = procedure_.captures().size();
  state_.progress = 0.0;
  try {
    Person person = load_person_if_any(person_);
    const Registration found = register_person(person, task_, procedure_.captures());
    save_person(person);
    const PersonFinger& finger = *person.find(task_.finger);
    const Vector3 p = found.X_BodyFt.translation / mm;
    state_.phase = Phase::kSaved;
    state_.message = fmt::format(
        "{:.1f} mm long, {:.1f} mm broad, {:.1f} mm deep; its centre at ({:.1f}, {:.1f}, {:.1f}) "
        "mm in the tracked body; the postures fit within {:.1f} mm and {:.1f} degrees",
        *finger.size.length / mm, *finger.size.breadth / mm, *finger.size.depth / mm, p.x(), p.y(),
        p.z(), found.height_residual / mm, found.turn_residual / deg);
    return true;
  } catch (const InputError& error) {
    state_.message = error.what();
  } catch (const OperationError& error) {
    state_.message = error.what();
  }
  state_.phase = Phase::kRefused;
  return false;
}

}  // namespace softfinger
