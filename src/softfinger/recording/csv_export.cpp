#include "softfinger/recording/csv_export.hpp"

#include <fmt/core.h>

#include <memory>
#include <system_error>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/recording/csv_writer.hpp"
#include "softfinger/recording/recording_tables.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// A folder with a file for each table. What was begun and not finished is taken away again.
class CsvFolder : public TableStore {
 public:
  explicit CsvFolder(const fs::path& folder) : folder_(folder) {
    std::error_code error;
    made_ = fs::create_directories(folder, error);
    if (error) {
      throw InputError(
          fmt::format("{}: cannot be made a directory: {}", folder.string(), error.message()));
    }
  }
  ~CsvFolder() override {
    if (finished_) return;
    std::error_code error;
    for (const fs::path& file : files_) fs::remove(file, error);
    if (made_) fs::remove(folder_, error);
  }
  CsvFolder(const CsvFolder&) = delete;
  CsvFolder& operator=(const CsvFolder&) = delete;

  std::unique_ptr<TableWriter> open(const std::string& name,
                                    const std::vector<TableColumn>& columns) override {
    const fs::path file = folder_ / (name + ".csv");
    auto writer = std::make_unique<CsvWriter>(file, columns);
    files_.push_back(file);
    return writer;
  }

  void finish() { finished_ = true; }

 private:
  fs::path folder_;
  std::vector<fs::path> files_;
  bool made_ = false, finished_ = false;
};

}  // namespace

std::string export_csv(const fs::path& recording, const fs::path& directory,
                       const std::function<void(double)>& progress) {
  RecordingReader reader(recording);
  reader.watch(progress);
  CsvFolder folder(directory);
  write_tables(reader, folder);
  folder.finish();
  return reader.how_it_was_cut();
}

}  // namespace softfinger
