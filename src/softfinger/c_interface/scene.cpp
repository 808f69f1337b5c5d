#include "softfinger/scene/scene.hpp"

#include <fmt/format.h>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/files/shipped_file.hpp"

sf_status sf_scene_finger(const char* scene, size_t index, char* name, size_t capacity,
                          size_t* count, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (scene == nullptr) return text.tell(SF_BAD_INPUT, "scene must not be NULL");
  return softfinger::guarded(text, [&] {
    const auto fingers =
        softfinger::load_scene(softfinger::file_or_shipped(softfinger::Shipped::kScene, scene))
            .fingers;
    if (count != nullptr) *count = fingers.size();
    if (index >= fingers.size()) {
      throw softfinger::InputError(
          fmt::format("{}: no finger {}; it has {}", scene, index, fingers.size()));
    }
    softfinger::copy_text(fingers[index].name, name, capacity, nullptr);
    return SF_DONE;
  });
}
