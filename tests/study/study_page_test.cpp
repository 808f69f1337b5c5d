// What the page of a running study is told.
#include "softfinger/study/report/study_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "study_place.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;
using testing::Not;
using Clock = std::chrono::steady_clock;

StudyHeadings headings() {
  StudyHeadings headings;
  headings.title = "a <study>";
  headings.kind = "nsga2";
  headings.parameters = {{"device.x"}};
  headings.quantities = {{"less", "formula", true, false}, {"more", "formula", true, true}};
  return headings;
}

nlohmann::json progress_of(StudyPage& page) {
  return nlohmann::json::parse(page.file("/progress.json").value());
}

TEST(StudyPage, SaysHowFarAStudyIsAndWhatIsBest) {
  StudyPage page(headings());
  nlohmann::json at = progress_of(page);
  EXPECT_EQ(at["state"], "running");
  EXPECT_EQ(at["title"], "a <study>");
  EXPECT_TRUE(at["best"].empty());
  EXPECT_TRUE(at["left_s"].is_null()) << "nothing is known of its speed";
  EXPECT_EQ(page.file("/report.html"), "");

  page.add({.number = 1, .parameters = {0.1}, .quantities = {2.0, 7.0}});
  page.add({.number = 0, .parameters = {0.2}, .quantities = {1.0, 5.0}});
  page.add({.number = 2, .parameters = {0.3}, .quantities = {-1.0, 9.0}, .reason = "too thin"});
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  page.at({.cases = 40, .done = 10, .recorded = 4, .designs = 3, .infeasible = 1});
  at = progress_of(page);
  EXPECT_EQ(at["evaluations"], 40);
  EXPECT_EQ(at["done"], 10);
  EXPECT_EQ(at["known_before"], 4);
  EXPECT_EQ(at["designs"], 3);
  EXPECT_EQ(at["not_feasible"], 1);
  EXPECT_NEAR(at["evaluations_per_s"].get<double>() * at["left_s"].get<double>(), 30.0, 1e-9);
  EXPECT_EQ(at["best"].dump(), R"([{"design":0,"objective":"less","value":1.0},)"
                               R"({"design":1,"objective":"more","value":7.0}])");
  EXPECT_EQ(at["report"], 3);
  const std::string report = page.file("/report.html").value();
  EXPECT_THAT(report, HasSubstr("<circle class=\"front\""));
  EXPECT_THAT(report, HasSubstr("too thin"));
  EXPECT_THAT(report, Not(HasSubstr("<html")));
  EXPECT_FALSE(page.file("/").has_value());
}

// Drawing takes time from the study: at most once a second, but in the end what is shown is all.
TEST(StudyPage, DrawsNowAndThenAndAtTheEnd) {
  StudyPage page(headings());
  page.add({.number = 0, .parameters = {0.1}, .quantities = {2.0, 7.0}});
  const std::string first = page.file("/report.html").value();
  page.add({.number = 1, .parameters = {0.2}, .quantities = {1.0, 9.0}});
  EXPECT_EQ(progress_of(page)["report"], 1);
  EXPECT_EQ(page.file("/report.html"), first);
  // A page that looks on is told before the study is gone, and gets the last drawing.
  std::thread end([&page] { page.end("finished"); });
  nlohmann::json at;
  const auto given_up = Clock::now() + std::chrono::seconds(60);
  while (at["state"] != "finished" && Clock::now() < given_up) at = progress_of(page);
  EXPECT_EQ(at["state"], "finished");
  EXPECT_EQ(at["report"], 2);
  EXPECT_NE(page.file("/report.html"), first);
  EXPECT_EQ(progress_of(page)["report"], 2);
  const auto begin = Clock::now();
  end.join();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(2)) << "it was told";
}

TEST(StudyPage, NobodyIsWaitedForWhoDoesNotLook) {
  StudyPage page(headings());
  const auto begin = Clock::now();
  page.end("finished");
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(1));
}

// The study tells each design that is known, also of those recorded before.
TEST(StudyPage, ARunTellsEveryDesign) {
  StudyPlace place;
  const Study study = place.study(
      std::string(StudyPlace::kVaryTwo) +
      "[objectives]\nf = { formula = \"device.mount.translation_mm.0\" }\n"
      "[constraints]\ng = { formula = \"device.mount.translation_mm.1\", at_most = 0.5 }\n"
      "[design]\nkind = \"lhs\"\nsize = 30\n");
  for (int run = 0; run < 2; ++run) {
    StudyPage page(headings_of(study));
    OneRank one;
    const StudySummary summary =
        run_study(study, {place.at("out"), {}}, one, place.stop,
                  {.progress = [&](const StudyProgress& at) { page.at(at); },
                   .design = [&](const StudyRow& row) { page.add(row); }});
    const nlohmann::json at = progress_of(page);
    EXPECT_EQ(at["designs"], 30);
    EXPECT_EQ(at["known_before"], run == 0 ? 0 : 30);
    EXPECT_EQ(at["not_feasible"], summary.progress.infeasible);
    EXPECT_GT(at["not_feasible"], 0);
    EXPECT_EQ(at["report"], 30);
    const StudyTable table = read_study_table(place.at("out"));
    double least = 2.0;
    for (const StudyRow& row : table.rows) {
      if (row.feasible()) least = std::min(least, row.quantities[0]);
    }
    EXPECT_EQ(at["best"][0]["value"], least);
  }
}

}  // namespace
}  // namespace softfinger
