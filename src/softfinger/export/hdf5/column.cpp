#include "softfinger/export/hdf5/column.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "softfinger/base/unit_words.hpp"
#include "softfinger/export/hdf5/handle.hpp"

namespace softfinger {
namespace {

/// UTF-8, of so many bytes, or H5T_VARIABLE.
Hdf5Handle text_type(std::size_t bytes) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  hdf5_check(H5Tset_size(type.id(), bytes));
  hdf5_check(H5Tset_cset(type.id(), H5T_CSET_UTF8));
  if (bytes != H5T_VARIABLE) hdf5_check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD));
  return type;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object, name.c_str(), type, scalar.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  hdf5_check(H5Awrite(attribute.id(), type, value));
}

/// An empty data set of one dimension.
Hdf5Handle make_data_set(hid_t group, const TableColumn& column, hid_t type) {
  const hsize_t none = 0;
  const hsize_t most = H5S_UNLIMITED;
  const hsize_t chunk = kHdf5Rows;
  const Hdf5Handle space(H5Screate_simple(1, &none, &most), H5Sclose);
  const Hdf5Handle creation = hdf5_creation(H5P_DATASET_CREATE);
  hdf5_check(H5Pset_chunk(creation.id(), 1, &chunk));
  if (H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
    hdf5_check(H5Pset_shuffle(creation.id()));
    hdf5_check(H5Pset_deflate(creation.id(), 1));
  }
  // Chunks are written once, as a whole: nothing is gained where they stay in memory.
  const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  hdf5_check(H5Pset_chunk_cache(access.id(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, 0,
                                H5D_CHUNK_CACHE_W0_DEFAULT));
  Hdf5Handle set(H5Dcreate2(group, column.name.c_str(), type, space.id(), H5P_DEFAULT,
                            creation.id(), access.id()),
                 H5Dclose);
  const std::string_view unit = column.unit.empty() ? unit_symbol(column.name) : column.unit;
  hdf5_attribute(set.id(), "unit", std::string(unit.empty() && !column.words ? "1" : unit));
  return set;
}

class Column : public Hdf5Column {
 public:
  Column(hid_t group, const TableColumn& column, Hdf5Handle type)
      : type_(std::move(type)), set_(make_data_set(group, column, type_.id())) {}

  void number(double) override {}
  void words(std::string_view) override {}

 protected:
  void append(std::size_t rows, const void* values) {
    if (rows == 0) return;
    const hsize_t begin = written_;
    const hsize_t count = rows;
    written_ += count;
    hdf5_check(H5Dset_extent(set_.id(), &written_));
    const Hdf5Handle all(H5Dget_space(set_.id()), H5Sclose);
    hdf5_check(H5Sselect_hyperslab(all.id(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr));
    const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    hdf5_check(H5Dwrite(set_.id(), type_.id(), memory.id(), all.id(), H5P_DEFAULT, values));
  }

 private:
  Hdf5Handle type_, set_;
  hsize_t written_ = 0;
};

class NumberColumn : public Column {
 public:
  NumberColumn(hid_t group, const TableColumn& column)
      : Column(group, column, {H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose}) {}

  void number(double value) override {
    // As the CSV: no infinities, no negative zeros.
    values_.push_back(std::isfinite(value) ? value + 0.0
                                           : std::numeric_limits<double>::quiet_NaN());
  }
  void write() override {
    append(values_.size(), values_.data());
    values_.clear();
  }

 private:
  std::vector<double> values_;
};

/// Words of a vocabulary: all of one size, so that they take little room.
class VocabularyColumn : public Column {
 public:
  VocabularyColumn(hid_t group, const TableColumn& column)
      : Column(group, column, text_type(column.most_bytes)), size_(column.most_bytes) {}

  void words(std::string_view text) override {
    values_.resize((rows_ + 1) * size_);
    text.copy(&values_[rows_++ * size_], size_);
  }
  void write() override {
    append(rows_, values_.data());
    values_.clear();
    rows_ = 0;
  }

 private:
  std::size_t size_, rows_ = 0;
  std::string values_;
};

class TextColumn : public Column {
 public:
  TextColumn(hid_t group, const TableColumn& column)
      : Column(group, column, text_type(H5T_VARIABLE)) {}

  void words(std::string_view text) override { values_.emplace_back(text); }
  void write() override {
    std::vector<const char*> pointers;
    for (const std::string& value : values_) pointers.push_back(value.c_str());
    append(pointers.size(), pointers.data());
    values_.clear();
  }

 private:
  std::vector<std::string> values_;
};

}  // namespace

std::unique_ptr<Hdf5Column> hdf5_column(hid_t group, const TableColumn& column) {
  if (!column.words) return std::make_unique<NumberColumn>(group, column);
  if (column.most_bytes > 0) return std::make_unique<VocabularyColumn>(group, column);
  return std::make_unique<TextColumn>(group, column);
}

void hdf5_attribute(hid_t object, const std::string& name, const std::string& text) {
  const char* const value = text.c_str();
  write_attribute(object, name, text_type(H5T_VARIABLE).id(), &value);
}

void hdf5_attribute(hid_t object, const std::string& name, double number) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, &number);
}

}  // namespace softfinger
