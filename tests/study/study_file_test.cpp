// Every mistake in a study file is told by file, line and key, before anything is evaluated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include <string>

#include "study_place.hpp"

namespace softfinger {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kObjective = "[objectives]\nf = { formula = \"1\" }\n";
constexpr const char* kLhs = "[design]\nkind = \"lhs\"\nsize = 4\n";

std::string varying(const std::string& vary, const std::string& design = kLhs) {
  return fmt::format("scene = \"plane\"\ndevice = \"thimble-3rrs\"\n[vary]\n{}\n{}{}", vary,
                     kObjective, design);
}

TEST(StudyFile, KnowsKeysOfDeviceFingerAndScene) {
  const StudyPlace place;
  const Study study = place.study(varying(R"toml(
device.geometry.crank_mm = { min = 9, max = 15 }
device.geometry.coupler_mm = { tie = "2 * device.geometry.crank_mm + device.geometry.disk_radius_mm - 8" }
device.mount.translation_mm.0 = { values = [0, 1] }
finger.material.youngs_modulus_kPa = { min = 20, max = 60, log = true }
finger.strain_limits.min = { min = 0.3, max = 0.4 }
finger.contact.tolerance_mm = { min = 0.02, max = 0.05 }
scene.finger.0.waypoint.0.time_s = { values = [0] }
device.matching.turn_on_skin_deg_per_s = { values = [60] }
)toml"));
  EXPECT_EQ(study.parameters.size(), 8u);
  EXPECT_EQ(study.parameters[1].key, "device.geometry.coupler_mm");
  const Design design = complete_design(study.parameters, {10.0, 1.0, 60.0, 30.0, 0.35, 0.03, 0.0});
  EXPECT_DOUBLE_EQ(design[1], 20.0);
  // Keys of one file stand together, in the order of the first of them.
  EXPECT_EQ(study.parameters[3].key, "device.matching.turn_on_skin_deg_per_s");
  EXPECT_DOUBLE_EQ(study.parameters[4].at(0.5), std::sqrt(20.0 * 60.0));
}

TEST(StudyFile, TellsWhatIsWrongWithParameters) {
  const StudyPlace place;
  EXPECT_THAT(place.refusal(varying("device.geometry.crnk_mm = { min = 9, max = 15 }")),
              AllOf(HasSubstr("study.toml:4: vary.device.geometry.crnk_mm"),
                    HasSubstr("did you mean device.geometry.crank_mm?")));
  EXPECT_THAT(place.refusal(varying("device.kind = { min = 9, max = 15 }")),
              HasSubstr("no number of this key"));
  EXPECT_THAT(place.refusal(varying("motor.geometry.crank_mm = { min = 9, max = 15 }")),
              HasSubstr("expected a key of device, finger or scene"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { min = 15, max = 15 }")),
              AllOf(HasSubstr("study.toml:4"), HasSubstr("the range is empty")));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { values = [] }")),
              HasSubstr("an array of 1 to"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { values = [9, 9.0] }")),
              HasSubstr("twice"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { min = 9 }")),
              HasSubstr("max: missing"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { min = 0, max = 9, log = true }")),
              HasSubstr("must be above 0 where log = true"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { min = 9, max = 15, lg = true }")),
              HasSubstr("did you mean 'log'?"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = {}")),
              HasSubstr("needs min and max, values, or tie"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = 9")),
              HasSubstr("expected a table"));
  EXPECT_THAT(place.refusal(varying("")), HasSubstr("names nothing to vary"));
  EXPECT_THAT(
      place.refusal(varying("scene.object.0.friction_coefficient = { values = [0, 1] }\n"
                            "scene.object.table.friction_coefficient = { values = [0, 1] }")),
      HasSubstr("scene.object"));
}

TEST(StudyFile, TellsWhatIsWrongWithTies) {
  const StudyPlace place;
  const std::string crank = "device.geometry.crank_mm = { min = 9, max = 15 }\n";
  const auto tied = [&](const std::string& formula) {
    return place.refusal(
        varying(crank + "device.geometry.coupler_mm = { tie = \"" + formula + "\" }"));
  };
  EXPECT_EQ(tied("2 * device.geometry.crank_mm"), "");
  EXPECT_THAT(tied("2 * crank"), HasSubstr("there is no number crank"));
  EXPECT_THAT(tied("2 * (device.geometry.crank_mm"), HasSubstr("is no formula that can be read"));
  EXPECT_THAT(tied("device.geometry.coupler_mm"), HasSubstr("is tied itself"));
  EXPECT_THAT(tied(""), HasSubstr("is no formula"));
  EXPECT_THAT(place.refusal(varying("device.geometry.coupler_mm = { tie = \"20\" }")),
              HasSubstr("leaves nothing to vary"));
}

TEST(StudyFile, TellsWhatIsWrongWithObjectives) {
  const StudyPlace place;
  const auto judged = [&](const std::string& objectives, const std::string& rest = kLhs) {
    return place.refusal(fmt::format(
        "scene = \"plane\"\ndevice = \"thimble-3rrs\"\n[vary]\ndevice.geometry.crank_mm = {{ min "
        "= 9, max = 15 }}\n[objectives]\n{}\n{}",
        objectives, rest));
  };
  EXPECT_EQ(judged("f = { measure = \"lagged.stress_error\", over_people = \"p95\" }"), "");
  EXPECT_THAT(judged("f = { measure = \"stress\" }"),
              HasSubstr("did you mean stress_error, lagged.stress_error or loaded.stress_error?"));
  EXPECT_THAT(judged("f = { measure = \"step_ms\" }"), HasSubstr("no measure is called 'step_ms'"));
  EXPECT_THAT(judged("f = { measure = \"iou\", over_people = \"p90\" }"), HasSubstr("over_people"));
  EXPECT_THAT(judged("f = {}"), HasSubstr("needs a measure, or a formula"));
  EXPECT_THAT(judged(""), HasSubstr("names no objective"));
  EXPECT_THAT(judged("feasible = { measure = \"iou\" }"), HasSubstr("is a column of every study"));
  EXPECT_THAT(judged("f = { measure = \"iou\" }",
                     "[constraints]\ng = { measure = \"iou\" }\n" + std::string(kLhs)),
              HasSubstr("needs at_most or at_least"));
  EXPECT_THAT(judged("f = { measure = \"iou\" }",
                     "[constraints]\ng = { measure = \"iou\", at_least = 3, at_most = 2 }\n" +
                         std::string(kLhs)),
              HasSubstr("constraints.g.at_most: must be no less than at_least, 3"));
  EXPECT_THAT(judged("f = { measure = \"iou\" }",
                     "[constraints]\nf = { measure = \"iou\" }\n" + std::string(kLhs)),
              HasSubstr("is an objective's name"));
}

TEST(StudyFile, TellsWhatIsWrongWithDesigns) {
  const StudyPlace place;
  const auto designed = [&](const std::string& design,
                            const std::string& vary =
                                "device.geometry.crank_mm = { min = 9, max = 15 }") {
    return place.refusal(varying(vary, "[design]\n" + design));
  };
  EXPECT_THAT(designed("kind = \"random\""), HasSubstr("expected one of: grid, lhs"));
  EXPECT_THAT(designed("kind = \"lhs\""), HasSubstr("size: missing"));
  EXPECT_THAT(designed("kind = \"lhs\"\nsize = 4\ngenerations = 3"), HasSubstr("of a search"));
  EXPECT_THAT(designed("kind = \"grid\""), HasSubstr("a grid needs values"));
  EXPECT_THAT(designed("kind = \"grid\"\nsize = 3"), HasSubstr("every combination"));
  EXPECT_THAT(designed("kind = \"nsga2\"\nsize = 8\ngenerations = 2"),
              HasSubstr("nsga2 wants two objectives or more"));
  EXPECT_THAT(designed("kind = \"nsga2\"\nsize = 10\ngenerations = 2"), HasSubstr("multiple of 4"));
  EXPECT_THAT(designed("kind = \"gaco\"\nsize = 7\ngenerations = 2"), HasSubstr("8 or more"));
  EXPECT_EQ(designed("kind = \"gaco\"\nsize = 10\ngenerations = 2"), "");
}

TEST(StudyFile, TellsWhatIsWrongWithFiles) {
  const StudyPlace place;
  EXPECT_THAT(place.refusal("device = \"thimble\"\n"),
              AllOf(HasSubstr("study.toml:1: device"), HasSubstr("thimble-3rrs")));
  EXPECT_THAT(place.refusal("device = \"none.toml\"\n"), HasSubstr("no such file"));
  EXPECT_THAT(place.refusal("scene = \"hand\"\ndevice = \"membrane\"\n"),
              HasSubstr("5 fingers; a study is of one"));
  EXPECT_THAT(place.refusal("scenes = \"plane\"\ndevice = \"membrane\"\n"),
              HasSubstr("an array of texts"));
  EXPECT_THAT(place.refusal("scene = \"plane\"\nscenes = [\"plane\"]\ndevice = \"membrane\"\n"),
              HasSubstr("leave one out"));
  EXPECT_THAT(place.refusal(varying("device.geometry.crank_mm = { min = 9, max = 15 }") +
                            "[populaton]\nsize = 2\n"),
              HasSubstr("did you mean 'population'?"));
}

}  // namespace
}  // namespace softfinger
