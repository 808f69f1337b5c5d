#include "softfinger/scene/scene.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/session/report/scene_report.hpp"

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

sf_status sf_scene_check(const char* scene, const sf_watch* watch, sf_table** out, char* error,
                         size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (scene == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "scene and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const softfinger::HostWatch host(softfinger::taken(watch, sizeof(sf_watch), "sf_watch"));
    const auto file = softfinger::file_or_shipped(softfinger::Shipped::kScene, scene);
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::scene_report(file, host.load_observer()).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
