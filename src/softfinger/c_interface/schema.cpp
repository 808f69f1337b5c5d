#include <fmt/core.h>

#include <memory>
#include <string_view>
#include <utility>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/scene/scene_schema.hpp"

namespace softfinger {
namespace {

std::string schema_of(std::string_view what, const char* kind) {
  if (what == "device") return kind == nullptr ? device_schema() : device_schema(kind);
  if (what == "scene") return scene_schema();
  if (what == "finger") return finger_schema();
  if (what == "person") return person_schema();
  throw InputError(fmt::format("what {}: there is scene, finger, person, device", what));
}

}  // namespace
}  // namespace softfinger

sf_status sf_schema(const char* what, const char* kind, sf_table** out, char* error,
                    size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (what == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "what and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::schema_of(what, kind);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
