#include "softfinger/recording/csv_export.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line) {
    if (c == ',') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

Table read(const fs::path& file) {
  std::ifstream stream(file);
  Table table;
  std::string line;
  std::getline(stream, line);
  table.header = fields(line);
  while (std::getline(stream, line)) table.rows.push_back(fields(line));
  return table;
}

TEST(CsvExport, WritesEveryTableSortedWithUnits) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 1.2;
  options.as_fast_as_possible = true;
  options.recording = directory / "run.db";
  options.record_state = true;
  const std::atomic<bool> stop{false};
  run_headless(options, stop);
  EXPECT_EQ(export_csv(directory / "run.db", directory / "out/csv"), "");

  const std::vector<std::pair<std::string, std::size_t>> expected = {
      {"pose", 1201}, {"bone", 1201},  {"contact", 1201}, {"timing", 1200}, {"configuration", 37},
      {"joints", 37}, {"command", 37}, {"nodes", 0},      {"samples", 0}};
  for (const auto& [name, rows] : expected) {
    const Table table = read(directory / ("out/csv/" + name + ".csv").c_str());
    ASSERT_FALSE(table.header.empty()) << name;
    EXPECT_EQ(table.header[0], "time_s") << name;
    if (rows > 0) {
      EXPECT_EQ(table.rows.size(), rows) << name;
    }
    EXPECT_GT(table.rows.size(), 0u) << name;
    double last = -1.0;
    for (const auto& row : table.rows) {
      ASSERT_EQ(row.size(), table.header.size()) << name;
      const double time = std::stod(row[0]);
      EXPECT_GE(time, last) << name;
      last = time;
    }
  }
  const Table pose = read(directory / "out/csv/pose.csv");
  EXPECT_EQ(pose.header, fields("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz"));
  EXPECT_EQ(pose.rows[1][0], "0.001");
  const Table contact = read(directory / "out/csv/contact.csv");
  EXPECT_EQ(contact.rows[0][7], "") << "no centroid without contact";
  const Table configuration = read(directory / "out/csv/configuration.csv");
  EXPECT_EQ(configuration.header[1], "pitch_deg");
  EXPECT_THROW(static_cast<void>(export_csv(directory / "run.db", directory / "out/csv")),
               InputError)
      << "never overwrites";

  // What was exported can be run again.
  options.trackers = {"csv:" + (directory / "out/csv/pose.csv").string()};
  options.recording.reset();
  options.record_state = false;
  options.duration.reset();
  EXPECT_EQ(run_headless(options, stop).steps, 1200);
}

}  // namespace
}  // namespace softfinger
