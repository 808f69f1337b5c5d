#include <cstddef>
#include <sstream>
#include <string>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/identification/press_fit.hpp"

namespace softfinger {
namespace {

PressFitOptions fit_options(const char* finger, const char* curve, const sf_fit_options& given) {
  PressFitOptions options;
  options.finger = file_or_shipped(Shipped::kFinger, finger);
  options.curve = curve;
  if (given.areas != nullptr) options.areas = given.areas;
  if (given.out != nullptr) options.out = given.out;
  if (given.parameters != nullptr) {
    std::istringstream words(given.parameters);
    for (std::string word; std::getline(words, word, ',');) options.parameters.push_back(word);
  }
  if (given.noise < 0 || given.noise > 2) {
    throw InputError("noise: must be 0 (the likelier), 1 (relative) or 2 (absolute)");
  }
  if (given.noise == 1) options.noise = ForceNoise::kRelative;
  if (given.noise == 2) options.noise = ForceNoise::kAbsolute;
  options.angle = given.pitch_rad;
  if (given.stop != nullptr) {
    options.simulated = [stop = given.stop](int) {
      if (*stop != 0) throw OperationError("finger fit: was ended before it had found anything");
    };
  }
  return options;
}

}  // namespace
}  // namespace softfinger

sf_status sf_finger_fit(const char* finger, const char* curve, const sf_fit_options* options,
                        sf_table** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (finger == nullptr || curve == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "finger, curve and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const softfinger::PressFitOptions how = softfinger::fit_options(
        finger, curve,
        softfinger::taken(options, offsetof(sf_fit_options, stop), "sf_fit_options"));
    const softfinger::PressFit found = softfinger::fit_press(how);
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::press_fit_json(found, how);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
