#include "softfinger/actuation/guard_setup.hpp"

#include <nlohmann/json.hpp>

#include <utility>
#include <vector>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

using nlohmann::json;

/// Of the program and of what is said between it and its guard: to be raised with either.
constexpr const char* kVersion = SOFTFINGER_VERSION "/2";

json ceiling_text(const TravelCeiling& ceiling) {
  json grid = json::array();
  for (const TravelCeiling::GridAxis& axis : ceiling.grid()) {
    grid.push_back({axis.axis, axis.min, axis.max, axis.count});
  }
  json skin = json::array();
  for (const Vector3& p_FS : ceiling.rest_skin()) skin.push_back({p_FS.x(), p_FS.y(), p_FS.z()});
  return {{"grid", grid}, {"rest_skin", skin}, {"depths", ceiling.depths()}};
}

std::shared_ptr<const TravelCeiling> read_ceiling(std::shared_ptr<const Device> device,
                                                  const json& text) {
  std::vector<TravelCeiling::GridAxis> grid;
  for (const json& axis : text.at("grid")) {
    grid.push_back({axis.at(0), axis.at(1), axis.at(2), axis.at(3)});
  }
  std::vector<Vector3> skin;
  for (const json& p : text.at("rest_skin")) skin.emplace_back(p.at(0), p.at(1), p.at(2));
  return std::make_shared<const TravelCeiling>(std::move(device), skin, std::move(grid),
                                               text.at("depths").get<std::vector<double>>());
}

}  // namespace

std::string to_text(const GuardSetup& setup) {
  json text = {{"version", kVersion},
               {"device_file", setup.device_file.string()},
               {"device_text", setup.device_text},
               {"mount_shift_m", setup.mount_shift},
               {"port", setup.line.port},
               {"rate_Hz", setup.line.rate},
               {"unpaced", setup.line.unpaced},
               {"wait_for_device", setup.wait_for_device}};
  if (setup.line.ceiling) text["ceiling"] = ceiling_text(*setup.line.ceiling);
  return text.dump();
}

GuardedDevice read_guard_setup(std::string_view text) {
  try {
    const json told = json::parse(text);
    if (told.at("version") != kVersion) {
      throw InputError(
          "the program and its softfinger-guard are of two versions; install them anew");
    }
    GuardedDevice guarded;
    guarded.setup.device_file = told.at("device_file").get<std::string>();
    guarded.setup.line.port = told.at("port");
    guarded.setup.line.rate = told.at("rate_Hz");
    guarded.setup.line.unpaced = told.at("unpaced");
    guarded.setup.wait_for_device = told.at("wait_for_device");
    guarded.setup.mount_shift = told.at("mount_shift_m");
    guarded.setup.device_text = told.at("device_text");
    // As the loop has it, whatever became of the file.
    guarded.device = load_device(guarded.setup.device_file, guarded.setup.device_text,
                                 guarded.setup.mount_shift);
    if (told.contains("ceiling")) {
      guarded.setup.line.ceiling = read_ceiling(guarded.device, told.at("ceiling"));
    }
    return guarded;
  } catch (const json::exception&) {
    throw InputError("softfinger-guard: it was not softfinger that started it");
  }
}

}  // namespace softfinger
