#include "softfinger/session/recorded_files.hpp"

#include <fmt/core.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mesh_file.hpp"

namespace softfinger {

namespace fs = std::filesystem;

RecordedFiles::RecordedFiles(const RecordingInfo& info, const fs::path& recording, bool with_meshes)
    : info_(info) {
  std::error_code error;
  std::string pattern = (fs::temp_directory_path(error) / "softfinger-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw OperationError(fmt::format("{}: cannot be created", pattern));
  }
  directory_ = pattern;
  try {
    for (const RecordingInfo::File& file : info.files) {
      // A recording may come from anyone: nothing is written outside the directory.
      if (std::find(file.path.begin(), file.path.end(), "..") != file.path.end() ||
          !file.path.is_absolute()) {
        throw InputError(fmt::format("{}: is damaged: it carries a file named {}",
                                     recording.string(), file.path.string()));
      }
      const fs::path copy = copy_of(file.path);
      fs::create_directories(copy.parent_path(), error);
      std::ofstream stream(copy, std::ios::binary);
      stream.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
      stream.close();
      if (!stream) throw OperationError(fmt::format("{}: cannot be written", copy.string()));
    }
    for (const RecordingInfo::Mesh& mesh : info.meshes) {
      if (with_meshes) link_mesh(mesh, recording);
    }
  } catch (...) {
    fs::remove_all(directory_, error);
    throw;
  }
}

void RecordedFiles::link_mesh(const RecordingInfo::Mesh& mesh, const fs::path& recording) const {
  if (!mesh.path.is_absolute() || mesh.path != mesh.path.lexically_normal()) {
    throw InputError(
        fmt::format("{}: is damaged: it names a mesh {}", recording.string(), mesh.path.string()));
  }
  if (read_mesh_source(mesh.path).hash != mesh.hash) {
    throw InputError(
        fmt::format("{}: was recorded with another content of {}; put that back, or "
                    "give --scene",
                    recording.string(), mesh.path.string()));
  }
  const fs::path link = copy_of(mesh.path);
  std::error_code error;
  fs::create_directories(link.parent_path(), error);
  fs::create_symlink(mesh.path, link, error);
  if (error) throw OperationError(fmt::format("{}: cannot be written", link.string()));
}

RecordedFiles::~RecordedFiles() {
  std::error_code error;
  fs::remove_all(directory_, error);
}

fs::path RecordedFiles::copy_of(const fs::path& file) const {
  return directory_ / file.relative_path();
}

SetupOptions RecordedFiles::setup_options() const {
  SetupOptions options;
  options.scene = copy_of(info_.scene);
  if (!info_.person.empty()) options.person = copy_of(info_.person);
  for (const RecordingInfo::Finger& finger : info_.fingers) {
    if (finger.device.empty()) continue;
    options.devices.push_back(finger.name + "=" + copy_of(finger.device).string());
  }
  return options;
}

}  // namespace softfinger
