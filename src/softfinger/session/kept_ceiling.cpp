#include "softfinger/session/kept_ceiling.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>
#include <vector>

#include "softfinger/actuation/force_ceiling.hpp"
#include "softfinger/base/code_hash.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/files/cache_folder.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/finger/rest_skin.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostKept = 1000;  // files
constexpr double kDeepest = 1.0;         // m, of a depth

void add(Hash& hash, std::string_view text) {
  hash.add(text.size()).add(std::span<const char>(text));
}

template <typename T>
void add(Hash& hash, const std::vector<T>& values) {
  hash.add(values.size()).add(std::span<const T>(values));
}

void add(Hash& hash, const FingerModel& model) {
  add(hash, model.as_read);
  // A person's size, or a fit, changes what the file says.
  hash.add(model.mesh.nodes.size());
  for (const Vector3& p : model.mesh.nodes) hash.add(p);
  add(hash, model.mesh.tetrahedra);
  add(hash, model.sample_nodes);
  add(hash, model.sample_rest_areas);
  add(hash, model.skin_triangles);
  for (const bool rigid : model.node_is_rigid) hash.add(rigid);
  add(hash, model.tetrahedron_material);
  for (const FingerModel::Material& material : model.materials) {
    hash.add(material.youngs_modulus).add(material.poissons_ratio).add(material.density);
  }
  const StrainLimit& limits = model.strain_limits;
  hash.add(limits.min).add(limits.max).add(limits.stiffness).add(limits.width);
  hash.add(model.dilatation).add(model.contact_tolerance).add(model.feature_contact);
}

void add(Hash& hash, const Device& device) {
  add(hash, device.settings().as_read);
  hash.add(device.settings().X_FB.rotation).add(device.settings().X_FB.translation);
}

/// Of all that a ceiling follows from; different ones for different salts.
std::uint64_t identity(std::uint64_t salt, const FingerModel& model, const Device& device,
                       double max_force) {
  Hash hash;
  hash.add(salt).add(code_hash()).add(active_instruction_set()).add(max_force);
  add(hash, model);
  add(hash, device);
  return hash.value();
}

std::uint64_t hash_of_values(std::uint64_t check, const TravelCeiling& ceiling) {
  Hash hash;
  hash.add(check);
  for (const TravelCeiling::GridAxis& axis : ceiling.grid()) {
    hash.add(axis.axis).add(axis.min).add(axis.max).add(axis.count);
  }
  add(hash, ceiling.depths());
  return hash.value();
}

bool has_mesh(const Device& device) {
  std::vector<SolidPiece> pieces(static_cast<std::size_t>(device.solid_piece_count()));
  device.solid_pieces(device.home(), pieces);
  return std::ranges::any_of(pieces, [](const SolidPiece& piece) {
    return std::holds_alternative<MeshShape>(piece.shape);
  });
}

/// Nobody else may put a table there.
bool is_users_own(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 && status.st_uid == ::geteuid() &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

std::string json_of(const TravelCeiling& ceiling, std::uint64_t check) {
  Json grid = Json::array();
  for (const TravelCeiling::GridAxis& axis : ceiling.grid()) {
    grid.push_back(
        {{"axis", axis.axis}, {"min", axis.min}, {"max", axis.max}, {"count", axis.count}});
  }
  const Json kept = {{"of", check},
                     {"grid", grid},
                     {"depths_m", ceiling.depths()},
                     {"hash", hash_of_values(check, ceiling)}};
  return kept.dump();
}

/// A number beyond 64 bits is read as a floating point one, whose conversion would be undefined.
template <typename T>
T whole(const Json& value) {
  if (!value.is_number_integer()) throw InputError("damaged");
  return value.get<T>();
}

/// Throws where it is not what json_of() writes.
TravelCeiling ceiling_of_json(const Json& kept, std::uint64_t check, const FingerModel& model,
                              const std::shared_ptr<const Device>& device) {
  const auto require = [](bool holds) {
    if (!holds) throw InputError("damaged");
  };
  require(whole<std::uint64_t>(kept.at("of")) == check);
  std::vector<TravelCeiling::GridAxis> grid;
  std::size_t places = 1;
  for (const Json& axis : kept.at("grid")) {
    grid.push_back({whole<int>(axis.at("axis")), axis.at("min").get<double>(),
                    axis.at("max").get<double>(), whole<int>(axis.at("count"))});
    const TravelCeiling::GridAxis& read = grid.back();
    require(read.axis >= 0 && read.axis < device->degrees_of_freedom() && read.count >= 2 &&
            read.count < 1000 && std::isfinite(read.min) && read.min < read.max);
    places *= static_cast<std::size_t>(read.count);
    require(places <= kMostBytes && grid.size() <= TravelCeiling::kMostAxes);
  }
  auto depths = kept.at("depths_m").get<std::vector<double>>();
  require(depths.size() == places);
  require(std::ranges::all_of(depths, [](double d) { return std::abs(d) <= kDeepest; }));
  TravelCeiling ceiling(device, rest_skin_points(model), std::move(grid), std::move(depths));
  require(whole<std::uint64_t>(kept.at("hash")) == hash_of_values(check, ceiling));
  return ceiling;
}

constexpr std::uint64_t kNameSalt = 1;
constexpr std::uint64_t kCheckSalt = 2;

void remove_oldest(const fs::path& folder) {
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, fs::path>> kept;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".ceiling") continue;
    const fs::file_time_type written = entry.last_write_time(error);
    if (!error) kept.emplace_back(written, entry.path());
  }
  if (kept.size() <= kMostKept) return;
  std::ranges::sort(kept);
  for (std::size_t i = 0; i < kept.size() - kMostKept; ++i) fs::remove(kept[i].second, error);
}

/// Whether it is kept or not is nobody's concern.
void keep(const fs::path& file, const TravelCeiling& ceiling, std::uint64_t check) {
  std::error_code error;
  const fs::path folder = file.parent_path();
  fs::create_directories(folder, error);
  // A umask may have let others write. Files that they put there meanwhile are theirs, and not
  // read.
  fs::permissions(folder, fs::perms::group_write | fs::perms::others_write,
                  fs::perm_options::remove, error);
  if (error || !is_users_own(folder)) return;
  const std::string text = json_of(ceiling, check);
  if (write_file_whole(file, [&](std::ostream& stream) { stream << text; },
                       {.owner_alone = true})) {
    remove_oldest(folder);
  }
}

}  // namespace

fs::path kept_ceiling_file(const FingerModel& model, const Device& device, double max_force) {
  const fs::path folder = user_cache_folder();
  if (folder.empty() || has_mesh(device)) return {};
  return folder / fmt::format("{:016x}.ceiling", identity(kNameSalt, model, device, max_force));
}

std::optional<TravelCeiling> read_kept_ceiling(const fs::path& file, const FingerModel& model,
                                               const std::shared_ptr<const Device>& device,
                                               double max_force) {
  if (!is_users_own(file) || !is_users_own(file.parent_path())) return {};
  try {
    return ceiling_of_json(Json::parse(read_text_file(file, kMostBytes)),
                           identity(kCheckSalt, model, *device, max_force), model, device);
  } catch (const std::exception&) {
    return {};  // it is made anew
  }
}

TravelCeiling kept_force_ceiling(const FingerModel& model,
                                 const std::shared_ptr<const Device>& device, double max_force,
                                 const std::stop_token& stop) {
  const fs::path file = kept_ceiling_file(model, *device, max_force);
  if (!file.empty()) {
    if (auto kept = read_kept_ceiling(file, model, device, max_force)) return std::move(*kept);
  }
  TravelCeiling ceiling = force_ceiling(model, device, max_force, stop);
  if (!file.empty()) keep(file, ceiling, identity(kCheckSalt, model, *device, max_force));
  return ceiling;
}

}  // namespace softfinger
