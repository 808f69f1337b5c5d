#pragma once

#include <hdf5.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "softfinger/recording/table.hpp"

namespace softfinger {

/// Rows that a column holds back until they are written, and a chunk of its data set.
inline constexpr std::size_t kHdf5Rows = 4096;

/// A data set that grows row by row. Throws Hdf5Failure.
class Hdf5Column {
 public:
  virtual ~Hdf5Column() = default;
  virtual void number(double value) = 0;
  virtual void words(std::string_view text) = 0;
  /// What is held back, at most kHdf5Rows.
  virtual void write() = 0;
};

[[nodiscard]] std::unique_ptr<Hdf5Column> hdf5_column(hid_t group, const TableColumn& column);

void hdf5_attribute(hid_t object, const std::string& name, const std::string& text);
void hdf5_attribute(hid_t object, const std::string& name, double number);

}  // namespace softfinger
