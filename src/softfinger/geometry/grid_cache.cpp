#include "softfinger/geometry/grid_cache.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <span>
#include <type_traits>

#include "softfinger/base/hash.hpp"
#include "softfinger/base/stop_check.hpp"
#include "softfinger/files/cache_folder.hpp"
#include "softfinger/files/whole_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using Content = SignedDistanceGrid::Content;

/// Changes whenever the layout of the file or the way grids are made does.
constexpr std::array<char, 8> kMagic{'s', 'f', 'g', 'r', 'i', 'd', '0', '1'};
constexpr std::uint64_t kMostLevels = 32;
/// Values that go in or out between two looks at whether anybody wants them.
constexpr std::size_t kValuesALook = std::size_t{1} << 20;

template <typename T, typename Take>
bool in_pieces(std::span<T> values, const std::stop_token& stop, const Take& take) {
  while (!values.empty()) {
    StopCheck::now(stop);
    const std::size_t count = std::min(values.size(), kValuesALook);
    if (!take(values.first(count))) return false;
    values = values.subspan(count);
  }
  return true;
}

std::uint64_t hash_of(const GridKey& key) {
  return Hash()
      .add(std::span<const char>(kMagic))
      .add(key.source_hash)
      .add(key.unit)
      .add(key.spacing)
      .add(key.margin)
      .value();
}

/// Writes values and hashes them on the way.
class Writer {
 public:
  Writer(std::ostream& stream, const std::stop_token& stop) : stream_(stream), stop_(stop) {}

  template <typename T>
  requires(std::is_arithmetic_v<T>) void put(const T& value) { put(std::span<const T>(&value, 1)); }
  template <typename T>
  void put(std::span<const T> values) {
    hash_.add(values);
    stream_.write(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::streamsize>(values.size_bytes()));
  }
  template <typename T>
  void put_vector(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    in_pieces(std::span<const T>(values), stop_, [&](std::span<const T> piece) {
      put(piece);
      return true;
    });
  }
  void put(const Eigen::AlignedBox3d& box) {
    put(std::span<const double>(box.min().data(), 3));
    put(std::span<const double>(box.max().data(), 3));
  }
  void finish() {
    const std::uint64_t value = hash_.value();
    stream_.write(reinterpret_cast<const char*>(&value), sizeof value);
  }

 private:
  std::ostream& stream_;
  const std::stop_token& stop_;
  Hash hash_;
};

/// Reads the same; never takes a size for granted that the rest of the file cannot have.
class Reader {
 public:
  Reader(const fs::path& file, const std::stop_token& stop)
      : stream_(file, std::ios::binary), stop_(stop) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    left_ = error || !stream_ ? 0 : static_cast<std::uint64_t>(size);
  }

  template <typename T>
  requires(std::is_arithmetic_v<T>) [[nodiscard]] bool get(T& value) {
    return get(std::span<T>(&value, 1));
  }
  template <typename T>
  [[nodiscard]] bool get(std::span<T> values) {
    if (values.size_bytes() > left_) return false;
    left_ -= values.size_bytes();
    stream_.read(reinterpret_cast<char*>(values.data()),
                 static_cast<std::streamsize>(values.size_bytes()));
    hash_.add(std::span<const T>(values));
    return static_cast<bool>(stream_);
  }
  template <typename T>
  [[nodiscard]] bool get_vector(std::vector<T>& values) {
    std::uint64_t size = 0;
    if (!get(size) || size > left_ / sizeof(T)) return false;
    values.resize(size);
    return in_pieces(std::span<T>(values), stop_, [&](std::span<T> piece) { return get(piece); });
  }
  [[nodiscard]] bool get(Eigen::AlignedBox3d& box) {
    return get(std::span<double>(box.min().data(), 3)) &&
           get(std::span<double>(box.max().data(), 3));
  }
  [[nodiscard]] bool ends_well() {
    const std::uint64_t expected = hash_.value();
    std::uint64_t value = 0;
    return get(value) && value == expected && left_ == 0;
  }

 private:
  std::ifstream stream_;
  const std::stop_token& stop_;
  std::uint64_t left_ = 0;
  Hash hash_;
};

bool finite(const Eigen::AlignedBox3d& box) {
  return box.min().allFinite() && box.max().allFinite() &&
         (box.min().array() < box.max().array()).all();
}

/// Whether every access of a query stays within what is there.
bool holds_together(const GridLevel& level, const Eigen::AlignedBox3d& domain, bool last) {
  if (!(level.spacing > 0.0) || !std::isfinite(level.spacing)) return false;
  double places = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int blocks = level.blocks[k];
    if (blocks < 1 || blocks > 1'000'000) return false;
    if (blocks * GridLevel::kCells * level.spacing < domain.sizes()[static_cast<int>(k)])
      return false;
    places *= blocks;
  }
  if (places != static_cast<double>(level.index.size())) return false;
  if (level.coefficients.size() % GridLevel::kBlockSize != 0) return false;
  const auto count = static_cast<std::int64_t>(level.coefficients.size() / GridLevel::kBlockSize);
  return std::ranges::all_of(
             level.index,
             [&](std::int32_t number) { return number < count && number >= (last ? 0 : -1); }) &&
         std::ranges::all_of(level.coefficients, [](float c) { return std::isfinite(c); });
}

bool holds_together(const TriangleMesh& mesh) {
  const auto count = static_cast<int>(mesh.positions.size());
  return std::ranges::all_of(mesh.triangles, [&](const std::array<int, 3>& t) {
    return std::ranges::all_of(t, [&](int vertex) { return vertex >= 0 && vertex < count; });
  });
}

bool read(Reader& reader, const GridKey& key, Content& content) {
  std::array<char, 8> magic{};
  std::uint64_t hash = 0;
  std::uint64_t levels = 0;
  if (!reader.get(std::span<char>(magic)) || magic != kMagic) return false;
  if (!reader.get(hash) || hash != hash_of(key)) return false;
  if (!reader.get(content.domain) || !reader.get(content.bounds)) return false;
  if (!finite(content.domain) || !finite(content.bounds)) return false;
  if (!reader.get(content.triangle_count)) return false;
  if (!reader.get(levels) || levels < 1 || levels > kMostLevels) return false;
  content.levels.resize(levels);
  for (GridLevel& level : content.levels) {
    if (!reader.get(level.spacing) || !reader.get(std::span<int>(level.blocks)) ||
        !reader.get_vector(level.index) || !reader.get_vector(level.coefficients) ||
        !holds_together(level, content.domain, &level == &content.levels.back())) {
      return false;
    }
    level.per_spacing = 1.0 / level.spacing;
  }
  std::vector<float> positions;
  std::vector<int> triangles;
  if (!reader.get_vector(positions) || !reader.get_vector(triangles) || !reader.ends_well() ||
      positions.size() % 3 != 0 || triangles.size() % 3 != 0) {
    return false;
  }
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    content.drawing.positions.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  }
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    content.drawing.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
  }
  return holds_together(content.drawing);
}

void write(Writer& writer, const GridKey& key, const Content& content) {
  writer.put(std::span<const char>(kMagic));
  writer.put(hash_of(key));
  writer.put(content.domain);
  writer.put(content.bounds);
  writer.put(content.triangle_count);
  writer.put(static_cast<std::uint64_t>(content.levels.size()));
  for (const GridLevel& level : content.levels) {
    writer.put(level.spacing);
    writer.put(std::span<const int>(level.blocks));
    writer.put_vector(level.index);
    writer.put_vector(level.coefficients);
  }
  std::vector<float> positions;
  for (const Vector3& p : content.drawing.positions) {
    for (const double x : p) positions.push_back(static_cast<float>(x));
  }
  std::vector<int> triangles;
  for (const auto& t : content.drawing.triangles)
    triangles.insert(triangles.end(), t.begin(), t.end());
  writer.put_vector(positions);
  writer.put_vector(triangles);
  writer.finish();
}

/// Whether caches may lie in it: a folder of the user's, and none that packages or administrators
/// fill, whoever runs the program.
bool is_own_folder(const fs::path& folder) {
  constexpr std::array kOfTheSystem{"/usr/", "/opt/", "/etc/", "/var/",  "/bin/", "/lib/",
                                    "/nix/", "/gnu/", "/srv/", "/snap/", "/sbin/"};
  const std::string name = folder.string() + "/";
  const bool of_the_system = std::ranges::any_of(
      kOfTheSystem, [&](const char* prefix) { return name.starts_with(prefix); });
  struct stat status {};
  return !of_the_system && ::stat(folder.c_str(), &status) == 0 && status.st_uid == ::geteuid();
}

}  // namespace

fs::path grid_cache_folder(const fs::path& mesh_file) {
  std::error_code error;
  const fs::path real = fs::canonical(mesh_file, error);
  const fs::path folder = error ? fs::absolute(mesh_file, error).parent_path() : real.parent_path();
  if (is_own_folder(folder)) return folder / ".softfinger-cache";
  return user_cache_folder();
}

fs::path grid_cache_file(const fs::path& mesh_file, const GridKey& key) {
  const fs::path folder = grid_cache_folder(mesh_file);
  if (folder.empty()) return {};
  std::error_code error;
  const fs::path real = fs::canonical(mesh_file, error);
  const fs::path name = (error ? mesh_file : real).filename();
  return folder / fmt::format("{}-{:016x}.grid", name.string(), hash_of(key));
}

std::optional<Content> read_grid_cache(const fs::path& file, const GridKey& key,
                                       const std::stop_token& stop) {
  Reader reader(file, stop);
  Content content;
  if (!read(reader, key, content)) return {};
  return content;
}

bool write_grid_cache(const fs::path& file, const GridKey& key, const Content& content,
                      const std::stop_token& stop) {
  if (file.empty()) return false;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  return write_file_whole(file, [&](std::ostream& stream) {
    Writer writer(stream, stop);
    write(writer, key, content);
  });
}

}  // namespace softfinger
