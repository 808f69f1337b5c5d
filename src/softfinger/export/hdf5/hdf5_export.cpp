#include "softfinger/export/hdf5/hdf5_export.hpp"

#include <fmt/core.h>

#include <memory>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/export/hdf5/column.hpp"
#include "softfinger/export/hdf5/file_driver.hpp"
#include "softfinger/export/hdf5/handle.hpp"
#include "softfinger/export/recording_facts.hpp"
#include "softfinger/recording/recording_tables.hpp"

namespace softfinger {
namespace {

/// HDF5 prints what fails; here callers say it.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &of_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, of_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* of_ = nullptr;
};

/// A group.
class Hdf5Table : public TableWriter {
 public:
  Hdf5Table(hid_t file, const std::string& name, const std::vector<TableColumn>& columns,
            const Hdf5Output& output)
      : group_(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, hdf5_creation(H5P_GROUP_CREATE).id(),
                          H5P_DEFAULT),
               H5Gclose),
        output_(output) {
    for (const TableColumn& column : columns) {
      columns_.push_back(hdf5_column(group_.id(), column));
    }
  }

  void number(double value) override { columns_.at(next_++)->number(value); }
  void words(std::string_view text) override { columns_.at(next_++)->words(text); }
  void end_row() override {
    next_ = 0;
    if (++rows_ % kHdf5Rows == 0) write();
  }
  void close() override { write(); }

 private:
  void write() {
    for (const auto& column : columns_) column->write();
    // Nobody wants the rest.
    if (output_.failed) throw Hdf5Failure{};
  }

  Hdf5Handle group_;
  const Hdf5Output& output_;
  std::vector<std::unique_ptr<Hdf5Column>> columns_;
  std::size_t next_ = 0, rows_ = 0;
};

class Hdf5Tables : public TableStore {
 public:
  Hdf5Tables(hid_t file, const Hdf5Output& output) : file_(file), output_(output) {}

  std::unique_ptr<TableWriter> open(const std::string& name,
                                    const std::vector<TableColumn>& columns) override {
    return std::make_unique<Hdf5Table>(file_, name, columns, output_);
  }

 private:
  hid_t file_;
  const Hdf5Output& output_;
};

}  // namespace

Exported export_hdf5(RecordingReader& reader, FileBeside& beside) {
  // Debian's library is for one thread.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  const QuietHdf5 quiet;
  Hdf5Output output{beside};
  try {
    const Hdf5Handle access = access_to(output);
    Hdf5Handle file(
        H5Fcreate("softfinger", H5F_ACC_TRUNC, hdf5_creation(H5P_FILE_CREATE).id(), access.id()),
        H5Fclose);
    for (const RecordingFact& fact : recording_facts(reader)) {
      std::visit([&](const auto& value) { hdf5_attribute(file.id(), fact.key, value); },
                 fact.value);
    }
    Hdf5Tables tables(file.id(), output);
    write_tables(reader, tables);
    file.close();
  } catch (const Hdf5Failure&) {
    if (output.failed) return {};
    throw InputError(fmt::format("{}: has names that HDF5 cannot hold", reader.file().string()));
  }
  return {.whole = !output.failed, .lack = {}};
}

}  // namespace softfinger
