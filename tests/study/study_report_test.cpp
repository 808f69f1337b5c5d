// What a report says of a study: its front, which parameters matter, one page that needs nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "softfinger/study/report/front.hpp"
#include "softfinger/study/report/sensitivity.hpp"
#include "softfinger/study/report/study_report.hpp"
#include "study_place.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

StudyTable table_of(const std::vector<std::pair<double, double>>& objectives) {
  StudyTable table;
  table.headings.title = "a <study>";
  table.headings.kind = "lhs";
  table.headings.parameters = {{"device.x"}};
  table.headings.quantities = {{"less", "formula", true, false}, {"more", "formula", true, true}};
  for (const auto& [less, more] : objectives) {
    table.rows.push_back({.number = static_cast<std::int64_t>(table.rows.size()),
                          .parameters = {less},
                          .quantities = {less, more}});
  }
  return table;
}

TEST(StudyReport, AFrontIsWhatNothingBeats) {
  StudyTable table = table_of(
      {{2.0, 5.0}, {1.0, 4.0}, {3.0, 5.0}, {1.0, 4.0}, {0.5, 9.0}, {4.0, 6.0}, {1.5, 3.9}});
  table.rows[4].reason = "cannot be built";
  EXPECT_THAT(front_of(table), ElementsAre(1u, 0u, 5u));
}

// Ishigami and Homma 1990, Proc ISUMA 398, a = 7, b = 0.1; the indices are known.
TEST(StudyReport, IshigamisIndicesAreWithinTwoHundredths) {
  StudyPlace place;
  const std::string x = "device.mount.translation_mm.";
  std::string text = "device = \"membrane\"\n[vary]\n";
  for (int k = 0; k < 3; ++k) {
    text += fmt::format("{}{} = {{ min = -3.14159265358979, max = 3.14159265358979 }}\n", x, k);
  }
  text += fmt::format(
      "[objectives]\ny = {{ formula = \"sin({0}0) + 7 * sin({0}1)^2 + 0.1 * {0}2^4 * sin({0}0)\" "
      "}}\n"
      "[design]\nkind = \"sobol\"\nsize = 4096\n",
      x);
  const StudyTable table = place.run_all(text);
  ASSERT_EQ(table.rows.size(), 4096u);
  const std::vector<FirstOrderIndex> indices = first_order_indices(table, 0);
  ASSERT_EQ(indices.size(), 3u);
  EXPECT_NEAR(indices[0].value, 0.3139, 0.02);
  EXPECT_NEAR(indices[1].value, 0.4424, 0.02);
  EXPECT_NEAR(indices[2].value, 0.0, 0.02);
  for (const FirstOrderIndex& index : indices) {
    EXPECT_LE(index.low, index.value);
    EXPECT_GE(index.high, index.value);
    EXPECT_LT(index.high - index.low, 0.1);
  }
}

TEST(StudyReport, FewDesignsHaveNoIndices) {
  EXPECT_THAT(first_order_indices(table_of({{1.0, 2.0}, {2.0, 1.0}}), 0), IsEmpty());
}

TEST(StudyReport, IsOnePageThatNeedsNothing) {
  const StudyPlace place;
  std::vector<std::pair<double, double>> objectives;
  for (int i = 0; i < 64; ++i) objectives.emplace_back(i, std::sqrt(i));
  StudyTable table = table_of(objectives);
  table.rows[7].reason = "device.toml:3: geometry.x: found 7 & more";
  table.rows[9].reason = "device.toml:3: geometry.x: found 9 & more";
  write_study_report(table, place.at("page"));
  const std::string page = place.read(place.at("page") / "report.html");
  EXPECT_THAT(page, HasSubstr("a &lt;study&gt;"));
  EXPECT_THAT(page, HasSubstr("64 designs (lhs), 62 of them feasible; the study is not finished."));
  EXPECT_THAT(page, HasSubstr("<td>2</td><td class=\"words\">device.toml:3: geometry.x: found 7 "
                              "&amp; more</td>"));
  EXPECT_THAT(page, HasSubstr("<circle class=\"front\""));
  EXPECT_THAT(page, Not(HasSubstr("href")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  for (const char* name : {"front-less-more.svg", "effect-device.x-less.svg", "indices-more.svg"}) {
    EXPECT_TRUE(fs::exists(place.at("page") / name)) << name;
  }
  write_study_report(table, place.at("page"));  // again, as the study goes on
}

TEST(StudyReport, OfOneObjectiveShowsTheBestSoFarAndOfNoneWhy) {
  const StudyPlace place;
  StudyTable table = table_of({{3.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}});
  table.headings.quantities[1].objective = false;
  write_study_report(table, place.at("one"));
  EXPECT_TRUE(fs::exists(place.at("one") / "best.svg"));
  for (StudyRow& row : table.rows) row.reason = "no";
  write_study_report(table, place.at("none"));
  EXPECT_THAT(place.read(place.at("none") / "report.html"), HasSubstr("0 of them feasible"));
  table.rows.clear();
  EXPECT_THROW(write_study_report(table, place.at("none")), InputError);
}

}  // namespace
}  // namespace softfinger
