#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/files/shipped_file.hpp"

namespace softfinger {
namespace {

constexpr std::array<std::pair<std::string_view, Shipped>, 4> kWhat{{{"scene", Shipped::kScene},
                                                                     {"device", Shipped::kDevice},
                                                                     {"finger", Shipped::kFinger},
                                                                     {"study", Shipped::kStudy}}};

Shipped kind_of(std::string_view what) {
  for (const auto& [word, kind] : kWhat) {
    if (word == what) return kind;
  }
  throw InputError(fmt::format("what {}: there is scene, device, finger, study", what));
}

}  // namespace
}  // namespace softfinger

sf_status sf_shipped_file(const char* what, const char* word, char* file, size_t capacity,
                          size_t* count, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (what == nullptr || word == nullptr) {
    return text.tell(SF_BAD_INPUT, "what and word must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    const auto found = softfinger::file_or_shipped(softfinger::kind_of(what), word);
    softfinger::copy_text(found.native(), file, capacity, count);
    return SF_DONE;
  });
}
