// The two normal forces, the magnitude of the vector sum and the sum of magnitudes, mean the same
// in every output. In a groove of two planes they differ by a known factor.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;

constexpr const char* kGroove = R"(
[[finger]]
name = "index"
model = "../fingers/index.toml"
device = "../devices/thimble-3rrs.toml"
tracker = "script"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 13.5]
[[finger.waypoint]]
time_s = 0.4
position_mm = [0.0, 0.0, 9.5]
[[finger.waypoint]]
time_s = 0.8
position_mm = [0.0, 0.0, 9.5]
[[object]]
name = "left"
shape = "plane"
rotation_vector_deg = [45.0, 0.0, 0.0]
friction_coefficient = 0.0
[[object]]
name = "right"
shape = "plane"
rotation_vector_deg = [-45.0, 0.0, 0.0]
friction_coefficient = 0.0
)";

/// Numbers of one column of a CSV file.
std::vector<double> column(const std::string& csv, const std::string& name) {
  std::istringstream lines(csv);
  std::vector<double> numbers;
  std::ptrdiff_t at = -1;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (at < 0) {
      at = std::ranges::find(cells, name) - cells.begin();
      if (at == std::ssize(cells)) return numbers;
    } else if (at < std::ssize(cells) && !cells[static_cast<std::size_t>(at)].empty()) {
      numbers.push_back(std::stod(cells[static_cast<std::size_t>(at)]));
    }
  }
  return numbers;
}

double greatest(const std::vector<double>& numbers) {
  return numbers.empty() ? 0.0 : std::ranges::max(numbers);
}

class NormalForce : public testing::Test {
 protected:
  void SetUp() override { place.write("scenes/groove.toml", kGroove); }

  [[nodiscard]] json answer(const std::vector<std::string>& arguments) const {
    const ProgramRun run = run_program(arguments);
    EXPECT_EQ(run.status, 0) << run.errors;
    return json::parse(run.output);
  }
  [[nodiscard]] json recorded() const {
    return answer(
        {"run", scene, "--headless", "--as-fast-as-possible", "--record", recording, "--json"});
  }
  [[nodiscard]] std::string exported() const {
    const ProgramRun run = run_program({"export", recording, "--to", place.path("csv")});
    EXPECT_EQ(run.status, 0) << run.errors;
    return place.read("csv/contact.csv");
  }

  const Workplace place;
  const std::string scene = place.path("scenes/groove.toml");
  const std::string recording = place.path("groove.sqlite");
};

TEST_F(NormalForce, MeansTheSameInRunRecordingAndEvaluation) {
  const json run = recorded();
  const double most = run.at("max_normal_force_N");
  const double most_sum = run.at("max_normal_force_sum_N");
  EXPECT_GT(most, 0.3);
  // Walls at 45 degrees push by sqrt(2) of what they bear together.
  EXPECT_NEAR(most_sum / most, 1.414, 0.02);
  EXPECT_EQ(run.at("fingers").at("index").at("max_normal_force_sum_N"), most_sum);

  const std::string contact = exported();
  EXPECT_NEAR(greatest(column(contact, "normal_force_N")), most, 1e-9);
  EXPECT_NEAR(greatest(column(contact, "normal_force_sum_N")), most_sum, 1e-9);

  double virtual_most = 0.0;
  double twin_most = 0.0;
  const json evaluation = answer({"evaluate", scene, "--json"});
  for (const json& frame : evaluation.at("frames")) {
    const double force = frame.at("virtual_force_N");
    virtual_most = std::max(virtual_most, force);
    twin_most = std::max(twin_most, frame.at("twin_force_N").get<double>());
    EXPECT_GE(frame.at("virtual_force_sum_N").get<double>(), force * (1.0 - 1e-12));
    EXPECT_GE(frame.at("twin_force_sum_N").get<double>(),
              frame.at("twin_force_N").get<double>() * (1.0 - 1e-12));
    if (force > 0.1) {
      EXPECT_NEAR(frame.at("virtual_force_sum_N").get<double>() / force, 1.414, 0.02);
    }
  }
  EXPECT_NEAR(virtual_most, most, 0.02 * most);
  EXPECT_GT(twin_most, 0.1);
}

TEST_F(NormalForce, IsReadFromRecordingsThatLackTheSum) {
  const double most = recorded().at("max_normal_force_N");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(recording.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "alter table steps drop column normal_force_sum_N", nullptr,
                         nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_TRUE(answer({"replay", recording, "--json"}).at("agree"));
  const std::string contact = exported();
  EXPECT_NEAR(greatest(column(contact, "normal_force_N")), most, 1e-9);
  EXPECT_TRUE(column(contact, "normal_force_sum_N").empty());
}

}  // namespace
}  // namespace softfinger
