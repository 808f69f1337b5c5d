#include "softfinger/export/export_recording.hpp"

#include <fmt/core.h>

#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/export/exported.hpp"
#include "softfinger/export/hdf5/hdf5_export.hpp"
#include "softfinger/export/mcap/mcap_export.hpp"
#include "softfinger/files/file_beside.hpp"
#include "softfinger/recording/csv_export.hpp"
#include "softfinger/recording/recording_reader.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file) {
  throw OperationError(fmt::format(
      "{}: cannot be written (is its folder there, and room on the disk?)", file.string()));
}

std::string export_file(const fs::path& recording, const fs::path& to,
                        const std::function<void(double)>& progress,
                        Exported (*write)(RecordingReader&, FileBeside&)) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(to, error))) {
    throw InputError(fmt::format("{}: exists already; export into a new file", to.string()));
  }
  RecordingReader reader(recording);
  reader.watch(progress);
  FileBeside file(to);
  if (file.descriptor() < 0) fail(to);
  const Exported exported = write(reader, file);
  if (!exported.whole || !file.take_its_place()) fail(to);
  const std::string cut = reader.how_it_was_cut();
  return cut + (cut.empty() || exported.lack.empty() ? "" : "; ") + exported.lack;
}

}  // namespace

std::string export_recording(const fs::path& recording, const fs::path& to,
                             const std::function<void(double)>& progress) {
  std::error_code error;
  const std::string ending = to.extension();
  if (ending.empty() || fs::is_directory(to, error)) return export_csv(recording, to, progress);
  if (ending == ".h5") return export_file(recording, to, progress, export_hdf5);
  if (ending == ".mcap") return export_file(recording, to, progress, export_mcap);
  throw InputError(fmt::format(
      "{}: ends in {}; give a file that ends in .h5 (HDF5) or .mcap (MCAP), or a folder, with a / "
      "at its end where its name has a dot, for CSV files",
      to.string(), ending));
}

}  // namespace softfinger
