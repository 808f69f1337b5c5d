#pragma once

#include <filesystem>

#include "softfinger/recording/recording_info.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {

/// The files a recording carries, laid out in a directory of their own as they lay when the run was
/// recorded, so that paths from one to another still hold. Removed at the end.
class RecordedFiles {
 public:
  /// `recording` names the source in messages. Without meshes of objects those may be changed or
  /// gone. Throws InputError, OperationError.
  RecordedFiles(const RecordingInfo& info, const std::filesystem::path& recording,
                bool with_meshes = true);
  ~RecordedFiles();
  RecordedFiles(const RecordedFiles&) = delete;
  RecordedFiles& operator=(const RecordedFiles&) = delete;

  /// What load_setup() needs to build the recorded run again.
  [[nodiscard]] SetupOptions setup_options() const;
  /// Where a file lies that was at this path.
  [[nodiscard]] std::filesystem::path copy_of(const std::filesystem::path& file) const;

 private:
  /// A mesh stays where it is, if it is still the same.
  void link_mesh(const RecordingInfo::Mesh& mesh, const std::filesystem::path& recording) const;

  const RecordingInfo& info_;
  std::filesystem::path directory_;
};

}  // namespace softfinger
