#include <string>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/export/export_recording.hpp"
#include "softfinger/session/replay.hpp"

sf_status sf_recording_export(const char* recording, const char* to, char* note, size_t capacity,
                              char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    softfinger::copy_text(softfinger::export_recording(recording, to), note, capacity, nullptr);
    return SF_DONE;
  });
}

sf_status sf_recording_replay(const char* recording, int32_t* agree, char* difference,
                              size_t capacity, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || agree == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and agree must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    const softfinger::ReplayResult result =
        softfinger::replay({.recording = recording, .scene = {}, .load_observer = {}});
    *agree = result.agree ? 1 : 0;
    softfinger::copy_text(result.difference, difference, capacity, nullptr);
    return SF_DONE;
  });
}
