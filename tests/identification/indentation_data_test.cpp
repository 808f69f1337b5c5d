#include "softfinger/identification/indentation_data.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <utility>

#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class IndentationData : public testing::Test {
 protected:
  using Read = MeasuredColumns (*)(const std::filesystem::path&);

  MeasuredColumns read(Read reader, const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return reader(file_);
  }
  /// What is said of `text`, the folder left out.
  std::string refusal(Read reader, const std::string& text) {
    try {
      static_cast<void>(read(reader, text));
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_THAT(line, StartsWith(file_.string()));
      return line.substr(line.rfind("data.csv"));
    }
    return "read";
  }

  TemporaryDirectory folder_;
  std::filesystem::path file_ = folder_ / "data.csv";
};

const std::string kRows = "0,0\n0.1,0.01\n0.2,0.02\n0.3,0.04\n0.4,0.08\n0.5,0.1\n";

TEST_F(IndentationData, IsInSiHoweverItIsWritten) {
  const MeasuredColumns curve = read(read_indentation_curve, "indentation_mm,force_N\n" + kRows);
  ASSERT_EQ(curve.first.size(), 6u);
  EXPECT_DOUBLE_EQ(curve.first[3], 0.3e-3);
  EXPECT_DOUBLE_EQ(curve.second[3], 0.04);
  EXPECT_THAT(curve.lines, testing::ElementsAre(2, 3, 4, 5, 6, 7));

  std::string windows = "\xef\xbb\xbfindentation_mm , force_N\r\n";
  for (const char letter : kRows) windows += letter == '\n' ? "\r\n\r\n" : std::string(1, letter);
  const MeasuredColumns same = read(read_indentation_curve, windows);
  EXPECT_EQ(same.first, curve.first);
  EXPECT_EQ(same.second, curve.second);
  EXPECT_THAT(same.lines, testing::ElementsAre(2, 4, 6, 8, 10, 12));

  const MeasuredColumns areas =
      read(read_contact_areas, "force_N,area_mm2\n1,60\n+0.5,4e1\n0.2,25\n");
  EXPECT_DOUBLE_EQ(areas.first[1], 0.5);
  EXPECT_DOUBLE_EQ(areas.second[1], 40e-6);
}

TEST_F(IndentationData, WhatIsWrongIsSaidWithItsLine) {
  const std::string header = "indentation_mm,force_N\n";
  const std::pair<std::string, std::string> bad[] = {
      {"", "data.csv: is empty, expected the header indentation_mm,force_N"},
      {"indentation_m,force_N\n" + kRows,
       "data.csv:1: header: column 1 is 'indentation_m': "
       "another unit, expected indentation_mm,force_N"},
      {"force_N,indentation_mm\n" + kRows,
       "data.csv:1: header: column 1 is 'force_N', expected "
       "indentation_mm,force_N"},
      {header + kRows + "0.6,1,2\n", "data.csv:8: has 3 columns, expected indentation_mm,force_N"},
      {header + kRows + "0.6,1e999\n", "data.csv:8: force_N: '1e999' is not a number"},
      {header + kRows + "0.6,nan\n", "data.csv:8: force_N: 'nan' is not a number"},
      {header + kRows + "0.6,1 N\n", "data.csv:8: force_N: '1 N' is not a number"},
      {header + kRows + "0.6,-1\n", "data.csv:8: force_N: -1 is negative, expected 0 or more"},
      {header + kRows + "0.5,1\n",
       "data.csv:8: indentation_mm: 0.5 does not exceed the 0.5 of the "
       "row before; expected one loading, depths rising"},
      {header + "0.1,1\n0.2,1\n0.3,1\n0.4,1\n0.5,0\n",
       "data.csv:6: too few points: 4 with depth and force above 0, expected at least 5"},
  };
  for (const auto& [text, message] : bad) {
    EXPECT_EQ(refusal(read_indentation_curve, text), message);
  }
  EXPECT_THAT(refusal(read_contact_areas, "force_N,area_mm2\n1,60\n0,40\n0.2,25\n"),
              AllOf(StartsWith("data.csv:3:"), HasSubstr("area_mm2"), EndsWith("above 0")));
  EXPECT_THAT(refusal(read_contact_areas, "force_N,area_mm2\n1,60\n2,40\n"),
              HasSubstr("expected at least 3"));
  EXPECT_THAT(refusal(read_contact_areas, "force_N,area_cm2\n1,6\n"), HasSubstr("another unit"));
}

}  // namespace
}  // namespace softfinger
