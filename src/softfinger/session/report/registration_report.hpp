#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "softfinger/session/finger_registration.hpp"

namespace softfinger {

/// The fields of `finger register --json`.
nlohmann::ordered_json registration_report(const std::filesystem::path& person,
                                           const FingerRegistration& registered);

}  // namespace softfinger
