#include <memory>
#include <optional>
#include <utility>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/session/finger_registration.hpp"
#include "softfinger/session/report/finger_report.hpp"
#include "softfinger/session/report/registration_report.hpp"

namespace softfinger {
namespace {

FingerRegistrationOptions registration_options(const char* person,
                                               const sf_register_options& given) {
  const auto size = [](double length) {
    return length != 0.0 ? std::optional(length) : std::nullopt;
  };
  FingerRegistrationOptions options{.person = person};
  if (given.finger != nullptr) options.finger = given.finger;
  if (given.scene != nullptr) options.scene = file_or_shipped(Shipped::kScene, given.scene);
  options.measured = {.length = size(given.length_m),
                      .breadth = size(given.breadth_m),
                      .depth = size(given.depth_m)};
  options.tracker = text_or_empty(given.tracker);
  if (given.model != nullptr) options.model = file_or_shipped(Shipped::kFinger, given.model);
  if (given.table_given != 0) options.table_height = given.table_m;
  return options;
}

}  // namespace
}  // namespace softfinger

sf_status sf_finger_show(const char* finger, sf_table** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (finger == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "finger and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const auto file = softfinger::file_or_shipped(softfinger::Shipped::kFinger, finger);
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::finger_report(*softfinger::FingerModel::load(file)).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}

sf_status sf_finger_register(const char* person, const sf_register_options* options, sf_table** out,
                             char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (person == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "person and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const sf_register_options given =
        softfinger::taken(options, sizeof(sf_register_options), "sf_register_options");
    const softfinger::HostWatch host(given.stop, given.progress);
    softfinger::FingerRegistrationObserver observer;
    observer.progress = host.observer().progress;
    const auto registered = softfinger::register_one(
        softfinger::registration_options(person, given), host.stop(), observer);
    auto table = std::make_unique<softfinger::Table>();
    table->text = softfinger::registration_report(person, registered).dump(2);
    *out = new sf_table(std::move(table));
    return SF_DONE;
  });
}
