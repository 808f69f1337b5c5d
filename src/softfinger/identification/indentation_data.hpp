#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger {

/// Two columns measured together, and where they stand.
struct MeasuredColumns {
  std::filesystem::path file;
  std::vector<double> first, second;  ///< SI
  std::vector<int> lines;             ///< of the file, from 1, one a row
  /// "FILE:LINE: message" as an InputError.
  [[noreturn]] void fail(std::size_t row, const std::string& message) const;
};

/// A quasi-static press on a flat plate: header `indentation_mm,force_N`; depths rise from row to
/// row, neither is negative, at least kLeastRows rows have a depth above 0. first: depth after
/// first touch, m; second: normal force, N. Throws InputError with file and line.
[[nodiscard]] MeasuredColumns read_indentation_curve(const std::filesystem::path& file);
inline constexpr int kLeastRows = 5;

/// Gross contact area in the same press: header `force_N,area_mm2`, both above 0, in any order.
/// first: normal force, N; second: area, m^2. Throws InputError with file and line.
[[nodiscard]] MeasuredColumns read_contact_areas(const std::filesystem::path& file);

}  // namespace softfinger
