// `finger register`: from poses of a body on a finger that rests on a table, to the person's file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "../support/turn_onto.hpp"
#include "program.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kTableHeight = 12.5 * mm;

class FingerRegister : public testing::Test {
 protected:
  /// The body's poses of a person `scale` times the finger file, each posture held for 1.5 s.
  void write_poses(double scale, std::size_t postures = RegistrationProcedure::kOrder.size()) {
    const auto model = FingerModel::load(place_.path("fingers/index.toml"));
    std::string csv = "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    double time = 0.0;
    for (std::size_t k = 0; k < postures; ++k) {
      const Matrix3 rotation =
          turn_onto(up_in_finger(RegistrationProcedure::kOrder.at(k)), Vector3::UnitZ());
      double lowest = 1.0;
      for (const int node : model->sample_nodes) {
        const Vector3& p = model->mesh.nodes[static_cast<std::size_t>(node)];
        lowest = std::min(lowest, scale * (rotation * p).z());
      }
      const Pose X_WFt{rotation, {0.03, 0.01 * static_cast<double>(k), kTableHeight - lowest}};
      const Pose X_WBody = X_WFt * X_BodyFt_.inverse();
      const Eigen::Quaterniond q(X_WBody.rotation);
      const Vector3 p = X_WBody.translation / mm;
      for (int i = 0; i < 16; ++i, time += 0.1) {
        csv += fmt::format("{:.1f},{},{},{},{},{},{},{}\n", time, p.x(), p.y(), p.z(), q.w(), q.x(),
                           q.y(), q.z());
      }
    }
    place_.write("body.csv", csv);
  }
  ProgramRun run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"finger", "register", "--person", place_.path("anna.toml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  ProgramRun run_tracked(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"--tracker", "csv:" + place_.path("body.csv"), "--model",
                                   place_.path("fingers/index.toml")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  void expect_refused(const ProgramRun& run, const std::string& words) const {
    EXPECT_EQ(run.status, 2) << run.errors;
    EXPECT_EQ(run.output, "");
    EXPECT_THAT(run.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(place_.path("anna.toml")));
  }

  const Workplace place_;
  const Pose X_BodyFt_{exp_rotation({0.3, -1.1, 2.0}), {4.0 * mm, -2.0 * mm, -15.0 * mm}};
};

TEST_F(FingerRegister, FindsBodyAndSizeAndLeavesWhatIsOfOthers) {
  write_poses(1.12);
  place_.write("anna.toml", "[thumb.size]\nbreadth_mm = 21\n");
  const ProgramRun found = run_tracked({"--table-mm", "12.5", "--json"});
  ASSERT_EQ(found.status, 0) << found.errors;
  EXPECT_THAT(found.errors, HasSubstr("5 of 5: rest the pad"));
  const json report = json::parse(found.output);
  const auto model = FingerModel::load(place_.path("fingers/index.toml"));
  EXPECT_NEAR(report.at("breadth_mm").get<double>(), 1.12 * *finger_size(*model).breadth / mm,
              0.01);
  EXPECT_NEAR(report.at("length_mm").get<double>(), 1.12 * *finger_size(*model).length / mm, 0.01);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(report.at("translation_mm").at(static_cast<std::size_t>(k)).get<double>(),
                X_BodyFt_.translation[k] / mm, 0.01);
  }
  EXPECT_LT(report.at("height_residual_mm").get<double>(), 0.01);
  const std::string file = place_.read("anna.toml");
  EXPECT_THAT(file, HasSubstr("[thumb.size]\nbreadth_mm = 21\n"));
  EXPECT_THAT(file, HasSubstr("[index.registration]"));
  // And a run takes it.
  const ProgramRun run =
      run_program({"run", place_.path("scenes/sphere.toml"), "--headless", "--as-fast-as-possible",
                   "--tracker", "csv:" + place_.path("body.csv"), "--duration-s", "0.1", "--person",
                   place_.path("anna.toml")});
  EXPECT_EQ(run.status, 0) << run.errors;
}

TEST_F(FingerRegister, WithoutTheTablesHeightTheSizeIsTaken) {
  write_poses(1.0);
  const ProgramRun found = run_tracked({"--json"});
  ASSERT_EQ(found.status, 0) << found.errors;
  EXPECT_NEAR(json::parse(found.output).at("table_height_mm").get<double>(), 12.5, 0.01);
}

TEST_F(FingerRegister, SizesAloneAreWritten) {
  EXPECT_EQ(run({"--finger", "ring", "--breadth-mm", "15.5"}).status, 0);
  EXPECT_EQ(run({"--finger", "ring", "--length-mm", "23"}).status, 0);
  // The file is kept, with what is new at the end of its table.
  EXPECT_THAT(place_.read("anna.toml"),
              HasSubstr("[ring.size]\nbreadth_mm = 15.5\nlength_mm = 23\n"));
}

// What is written is what runs take.
TEST_F(FingerRegister, FingersThatRunsWouldRefuseAreRefused) {
  const auto run_with_person = [&] {
    return run_program({"run", place_.path("scenes/sphere.toml"), "--headless", "--duration-s",
                        "0.01", "--as-fast-as-possible", "--person", place_.path("anna.toml")});
  };
  expect_refused(run({"--finger", "toe", "--breadth-mm", "16"}), "thumb, index, middle, ring");
  expect_refused(
      run({"--finger", "toe", "--breadth-mm", "16", "--scene", place_.path("scenes/sphere.toml")}),
      "sphere.toml");
  for (const char* name : {"thumb", "index", "middle", "ring", "pinky"}) {
    EXPECT_EQ(run({"--finger", name, "--breadth-mm", "16"}).status, 0);
    const ProgramRun taken = run_with_person();
    EXPECT_EQ(taken.status, 0) << taken.errors;
  }
  // Or those of the scene at hand.
  place_.replace_line("scenes/sphere.toml", "name = \"index\"", "name = \"toe\"");
  EXPECT_EQ(
      run({"--finger", "toe", "--breadth-mm", "16", "--scene", place_.path("scenes/sphere.toml")})
          .status,
      0);
  const ProgramRun taken = run_with_person();
  EXPECT_EQ(taken.status, 0) << taken.errors;
}

TEST_F(FingerRegister, BadInputWritesNothing) {
  write_poses(1.0);
  expect_refused(run({}), "--tracker SPEC");
  expect_refused(run({"--breadth-mm", "nan"}), "--breadth-mm");
  expect_refused(run({"--breadth-mm", "0"}), "--breadth-mm");
  expect_refused(run({"--breadth-mm", "16", "--finger", "a b"}), "--finger");
  expect_refused(run({"--breadth-mm", "16", "--table-mm", "0"}), "--table-mm");
  expect_refused(run({"--tracker", "page", "--model", place_.path("fingers/index.toml")}), "page");
  expect_refused(run({"--tracker", "udp:0"}), "--model");
  expect_refused(run_tracked({"--table-mm", "inf"}), "--table-mm");
  expect_refused(run_tracked({"--table-mm", "60"}), "height given for the table");
  write_poses(1.0, 3);
  expect_refused(run_tracked({}), "posture 'tip'");
}

}  // namespace
}  // namespace softfinger
