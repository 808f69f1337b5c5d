// A study from its file to its table: what is evaluated, recorded, resumed and merged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "../support/folders.hpp"
#include "mortal_rank.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/study/search.hpp"
#include "study_place.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::string of_formulas(const std::string& objectives, const std::string& design) {
  return fmt::format("{}[objectives]\n{}\n[design]\n{}\n", StudyPlace::kVaryTwo, objectives,
                     design);
}
const std::string kSum = of_formulas(
    "f = { formula = \"device.mount.translation_mm.0 + 2 * device.mount.translation_mm.1\" }",
    "kind = \"lhs\"\nsize = 12");

TEST(RunStudy, EvaluatesFormulasOfDesigns) {
  StudyPlace place;
  const StudyTable table = place.run_all(kSum);
  ASSERT_EQ(table.rows.size(), 12u);
  EXPECT_TRUE(table.finished);
  EXPECT_EQ(table.headings.parameters[0].key, "device.mount.translation_mm.0");
  for (const StudyRow& row : table.rows) {
    EXPECT_DOUBLE_EQ(row.quantities[0], row.parameters[0] + 2.0 * row.parameters[1]);
    EXPECT_TRUE(row.feasible());
  }
  EXPECT_THAT(place.csv(), StartsWith("design,device.mount.translation_mm.0,device.mount."
                                      "translation_mm.1,f,feasible,reason\n0,"));
}

TEST(RunStudy, GoesOnWhereItWasKilled) {
  StudyPlace whole;
  whole.run_all(kSum);
  StudyPlace killed;
  killed.write("study.toml", kSum);
  for (const std::size_t life : {0u, 1u, 5u}) {
    MortalRank rank(life);
    EXPECT_THROW(static_cast<void>(killed.run("out", {}, rank)), OperationError);
  }
  const StudySummary summary = killed.run();
  EXPECT_EQ(summary.progress.recorded, 6u) << "what was done is done";
  EXPECT_EQ(killed.csv(), whole.csv());
  EXPECT_EQ(killed.run().progress.recorded, 12u);
  EXPECT_EQ(killed.csv(), whole.csv());
  EXPECT_THAT(killed.told, IsEmpty());
}

TEST(RunStudy, ShardsTogetherAreTheWhole) {
  StudyPlace whole;
  whole.run_all(kSum);
  StudyPlace parts;
  parts.write("study.toml", kSum);
  for (const std::size_t number : {3u, 1u}) {
    EXPECT_EQ(parts.run("out", Shard{number, 3}).end, StudyEnd::kShardDone);
  }
  EXPECT_THROW(static_cast<void>(read_study_table(parts.at("out"))), InputError);
  const StudySummary summary = parts.run();
  EXPECT_EQ(summary.progress.recorded, 8u) << "of two shards of three";
  EXPECT_EQ(parts.csv(), whole.csv());
  EXPECT_FALSE(fs::exists(parts.at("out") / "journal-1-of-3.sqlite"));
}

TEST(RunStudy, StopsWhereItIsAskedTo) {
  StudyPlace place;
  place.write("study.toml", kSum);
  place.stop = true;
  EXPECT_EQ(place.run().end, StudyEnd::kStopped);
  EXPECT_FALSE(read_study_table(place.at("out")).finished);
  place.stop = false;
  EXPECT_EQ(place.run().end, StudyEnd::kFinished);
}

TEST(RunStudy, RecordsDesignsThatCannotBe) {
  StudyPlace place;
  const StudyTable table = place.run_all(
      "device = \"thimble-3rrs\"\n[vary]\n"
      "device.geometry.crank_mm = { values = [12, 1, 13] }\n"
      "[objectives]\nf = { formula = \"device.geometry.crank_mm\" }\n[design]\nkind = \"grid\"\n");
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_TRUE(table.rows[0].feasible());
  // The reader's own words, with the file as the study calls it and the line of the key.
  EXPECT_THAT(table.rows[1].reason, StartsWith("thimble-3rrs:"));
  EXPECT_TRUE(std::isnan(table.rows[1].quantities[0]));
  EXPECT_TRUE(table.rows[2].feasible());
  EXPECT_THAT(place.csv(), HasSubstr("\n1,1,,false,\"thimble-3rrs:"));
}

TEST(RunStudy, SaysWhyNoDesignIsFeasible) {
  StudyPlace place;
  place.write("study.toml",
              "device = \"thimble-3rrs\"\n[vary]\n"
              "device.geometry.crank_mm = { values = [1, 2] }\n"
              "[objectives]\nf = { formula = \"1\" }\n[design]\nkind = \"grid\"\n");
  const StudySummary summary = place.run();
  EXPECT_EQ(summary.progress.infeasible, 2u);
  EXPECT_THAT(summary.first_reason, HasSubstr("thimble-3rrs:"));
}

TEST(RunStudy, HoldsDesignsAgainstConstraints) {
  StudyPlace place;
  const StudyTable table = place.run_all(
      of_formulas("f = { formula = \"1 / device.mount.translation_mm.0\" }",
                  "kind = \"lhs\"\nsize = 40") +
      "[constraints]\nx = { formula = \"device.mount.translation_mm.0\", at_most = 0.5 }\n"
      "y = { formula = \"device.mount.translation_mm.1\", at_least = 0.25, at_most = 0.75 }\n");
  int feasible = 0;
  for (const StudyRow& row : table.rows) {
    const bool keeps =
        row.parameters[0] <= 0.5 && row.parameters[1] >= 0.25 && row.parameters[1] <= 0.75;
    EXPECT_EQ(row.feasible(), keeps) << row.reason;
    feasible += keeps ? 1 : 0;
    if (row.parameters[0] > 0.5) {
      EXPECT_EQ(row.reason, fmt::format("x is {:.6g}, above 0.5", row.parameters[0]));
    }
    EXPECT_EQ(row.quantities.size(), 3u);
  }
  EXPECT_GT(feasible, 0);
  EXPECT_LT(feasible, 40);
}

TEST(RunStudy, GivesTheDeviceFileOfADesign) {
  StudyPlace place;
  const StudyTable table = place.run_all(
      "device = \"thimble-3rrs\"\n[vary]\n"
      "device.geometry.crank_mm = { values = [12, 11.5] }\n"
      "device.matching.turn_on_skin_deg_per_s = { values = [40] }\n"  // which the file leaves out
      "[objectives]\nf = { formula = \"1\" }\n[design]\nkind = \"grid\"\n");
  export_device(table, 1, place.at("design.toml"));
  const auto device = load_device(place.at("design.toml"));
  EXPECT_THAT(device->settings().as_read, HasSubstr("\"crank_mm\": 11.5"));
  EXPECT_THAT(device->settings().as_read, HasSubstr("\"turn_on_skin_deg_per_s\": 40"));
  EXPECT_THAT(place.read(place.at("design.toml")), HasSubstr("# Design 1 of study study"));
  EXPECT_THROW(export_device(table, 1, place.at("design.toml")), InputError);
  EXPECT_THROW(export_device(table, 2, place.at("other.toml")), InputError);
}

// What is recorded belongs to these files, this study and this program.
TEST(RunStudy, RefusesToMixStudies) {
  StudyPlace place;
  place.run_all(kSum);
  place.write("study.toml", kSum + "# other\n");
  try {
    static_cast<void>(place.run());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("journal.sqlite"), HasSubstr("another content of study.toml")));
  }
  place.write("study.toml", kSum);
  EXPECT_EQ(place.run().progress.recorded, 12u);
}

TEST(RunStudy, RefusesAnotherDeviceOrMesh) {
  StudyPlace place;
  const fs::path shipped = source_folder();
  for (const char* folder : {"devices", "fingers", "scenes"}) {
    fs::copy(shipped / folder, place.at(folder));
  }
  place.write("study.toml",
              "scene = \"scenes/plane.toml\"\ndevice = \"devices/membrane.toml\"\n[vary]\n"
              "device.geometry.ring_radius_mm = { values = [7] }\n"
              "[objectives]\nf = { formula = \"1\" }\n[design]\nkind = \"grid\"\n");
  MortalRank none(0);
  EXPECT_THROW(static_cast<void>(place.run("out", {}, none)), OperationError);
  for (const char* name : {"devices/membrane.toml", "fingers/index.msh", "scenes/plane.toml"}) {
    const std::string content = place.read(place.at(name));
    std::ofstream(place.at(name), std::ios::app) << "\n";
    try {
      static_cast<void>(place.run("out", {}, none));
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(fmt::format("another content of {}", name)));
    }
    std::ofstream(place.at(name)) << content;
  }
}

TEST(RunStudy, TwoRunsDoNotWriteOneJournal) {
  StudyPlace place;
  const Study study = place.study(kSum);
  const Journal held(place.at("out"), {}, study_facts(study), {}, [](const std::string&) {});
  try {
    static_cast<void>(place.run());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another run of this study writes it just now"));
  }
  EXPECT_EQ(place.run("out", Shard{1, 2}).end, StudyEnd::kShardDone) << "a shard has its own";
}

// What a study measures is what `evaluate` says of that design.
TEST(RunStudy, MeasuresWhatEvaluateDoes) {
  StudyPlace place;
  const fs::path scene = place.write(
      "scene.toml", fmt::format("[[finger]]\nname = \"index\"\nmodel = \"{}/fingers/index.toml\"\n"
                                "[[finger.waypoint]]\ntime_s = 0.0\nposition_mm = [0.0, 0.0, 9.0]\n"
                                "[[finger.waypoint]]\ntime_s = 0.3\nposition_mm = [0.0, 0.0, 6.0]\n"
                                "[[finger.waypoint]]\ntime_s = 0.6\nposition_mm = [0.5, 0.0, 6.2]\n"
                                "[[object]]\nshape = \"plane\"\n",
                                source_folder()));
  const StudyTable table = place.run_all(R"toml(
scene = "scene.toml"
device = "thimble-3rrs"
[vary]
device.geometry.disk_radius_mm = { values = [8] }
[objectives]
force = { measure = "normal_force_error" }
worst = { measure = "normal_force_error", over_frames = "worst" }
iou = { measure = "iou", maximise = true }
stress = { measure = "stress_error" }
lagged = { measure = "lagged.pressure_error" }
loaded = { measure = "loaded.normal_force_error" }
free = { measure = "frames_free" }
greatest = { measure = "max_normal_force_N" }
area = { measure = "max_contact_area_mm2" }
sent = { measure = "commands_sent" }
spread = { measure = "area_spread_rate_error" }
[design]
kind = "grid"
)toml");
  ASSERT_EQ(table.rows.size(), 1u);
  EvaluationOptions options;
  options.run.scene = scene;
  options.run.devices = {fs::path(source_folder()) / "devices/thimble-3rrs.toml"};
  const std::atomic<bool> stop{false};
  const Evaluation evaluation = evaluate(options, stop);
  const RenderingMeasures mean = evaluation.commanded.mean();
  const std::vector<double>& q = table.rows[0].quantities;
  ASSERT_GT(evaluation.commanded.frames(FrameKind::kBoth), 10);
  const AreaSpreadRates spread = area_spread_rates(evaluation, 0);
  double worst = 0.0;
  for (const EvaluatedFrame& frame : evaluation.frames) {
    worst = std::max(worst, frame.commanded.normal_force_error);
  }
  EXPECT_THAT(
      q, ElementsAre(mean.normal_force_error, worst, mean.iou, mean.stress_error,
                     evaluation.lagged.mean().pressure_error,
                     evaluation.loaded.mean().normal_force_error,
                     evaluation.commanded.frames(FrameKind::kFree),
                     evaluation.run.all.max_normal_force, evaluation.run.all.max_contact_area / mm2,
                     static_cast<double>(evaluation.run.all.commands_sent),
                     std::abs(spread.twin - spread.virtual_side) / spread.virtual_side));
  EXPECT_GT(spread.virtual_side, 0.0);
}

double hypervolume(const StudyTable& table) {
  std::vector<std::pair<double, double>> points;
  for (const StudyRow& row : table.rows) {
    points.emplace_back(row.quantities[0], row.quantities[1]);
  }
  std::ranges::sort(points);
  double volume = 0.0;
  double least = 2.0;  // of the reference point
  for (const auto& [first, second] : points) {
    if (second >= least || first >= 2.0) continue;
    volume += (2.0 - first) * (least - second);
    least = second;
  }
  return volume;
}

// Zitzler, Deb and Thiele 2000, Evol Comput 8:173, test function 1 of two parameters: the front is
// f2 = 1 - sqrt(f1), whose hypervolume to (2, 2) is 4 - 1/3.
TEST(RunStudy, SearchesAFront) {
  if (!can_search()) GTEST_SKIP() << "built without pagmo";
  const std::string g = "(1 + 9 * device.mount.translation_mm.1)";
  const std::string zdt1 = of_formulas(
      fmt::format("f1 = {{ formula = \"device.mount.translation_mm.0\" }}\n"
                  "f2 = {{ formula = \"{0} * (1 - sqrt(device.mount.translation_mm.0 / {0}))\" }}",
                  g),
      "kind = \"nsga2\"\nsize = 20\ngenerations = 40\nseed = 2");
  StudyPlace place;
  const StudyTable table = place.run_all(zdt1);
  ASSERT_EQ(table.rows.size(), 20u * 41u);
  EXPECT_NEAR(hypervolume(table), 4.0 - 1.0 / 3.0, 0.05);
  // Killed in the middle of a generation it goes the same way.
  StudyPlace killed;
  killed.write("study.toml", zdt1);
  MortalRank rank(133);
  EXPECT_THROW(static_cast<void>(killed.run("out", {}, rank)), OperationError);
  EXPECT_EQ(killed.run().end, StudyEnd::kFinished);
  EXPECT_EQ(killed.csv(), place.csv());
  // Shards do their part of a generation, and wait for each other.
  StudyPlace parts;
  parts.write("study.toml", zdt1);
  EXPECT_EQ(parts.run("out", Shard{1, 2}).end, StudyEnd::kAwaitsOthers);
  EXPECT_EQ(parts.run("out", Shard{2, 2}).end, StudyEnd::kAwaitsOthers) << "of the next one";
  EXPECT_EQ(parts.run("out", Shard{1, 2}).end, StudyEnd::kAwaitsOthers);
  EXPECT_EQ(parts.run().end, StudyEnd::kFinished);
  EXPECT_EQ(parts.csv(), place.csv());
}

TEST(RunStudy, SearchesAmongValuesOnALogScaleAndWithinConstraints) {
  if (!can_search()) GTEST_SKIP() << "built without pagmo";
  StudyPlace place;
  const StudyTable table = place.run_all(R"toml(
device = "membrane"
[vary]
device.geometry.ring_radius_mm = { values = [6, 7, 8] }
device.limits.joint_rate_mm_per_s = { min = 1, max = 1000, log = true }
[objectives]
f = { formula = "(device.geometry.ring_radius_mm - 7)^2 + (log10(device.limits.joint_rate_mm_per_s) - 2)^2" }
[constraints]
slow = { formula = "device.limits.joint_rate_mm_per_s", at_most = 50 }
[design]
kind = "gaco"
size = 16
generations = 20
)toml");
  double best = std::numeric_limits<double>::infinity();
  Design at;
  for (const StudyRow& row : table.rows) {
    if (!row.feasible() || row.quantities[0] >= best) continue;
    best = row.quantities[0];
    at = row.parameters;
  }
  ASSERT_EQ(at.size(), 2u);
  EXPECT_EQ(at[0], 7.0);
  EXPECT_NEAR(at[1], 50.0, 5.0) << "as fast as is allowed";
}

}  // namespace
}  // namespace softfinger
