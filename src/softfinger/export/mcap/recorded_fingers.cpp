#include "softfinger/export/mcap/recorded_fingers.hpp"

#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/session/recorded_files.hpp"
#include "softfinger/session/worn_device.hpp"

namespace softfinger {

RecordedFingers recorded_fingers(const RecordingReader& reader) {
  const RecordingInfo& info = reader.info();
  RecordedFingers recorded{.fingers = std::vector<RecordedFinger>(info.fingers.size()), .lack = {}};
  try {
    const RecordedFiles files(info, reader.file(), /*with_meshes=*/false);
    std::optional<Person> person;
    if (!info.person.empty()) person = load_person(files.copy_of(info.person));
    for (std::size_t i = 0; i < info.fingers.size(); ++i) {
      const RecordingInfo::Finger& of = info.fingers[i];
      RecordedFinger& finger = recorded.fingers[i];
      const PersonFinger* const known = person ? person->find(of.name) : nullptr;
      finger.model =
          FingerModel::load(files.copy_of(of.model), known != nullptr ? known->size : FingerSize{});
      if (!of.device.empty()) finger.device = mounted_on(*finger.model, files.copy_of(of.device));
    }
  } catch (const InputError& error) {
    recorded.lack = error.what();
  } catch (const OperationError& error) {  // no room to lay out the files
    recorded.lack = error.what();
  }
  return recorded;
}

}  // namespace softfinger
