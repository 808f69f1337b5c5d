// Presses, evaluations, devices and recordings through the C interface. That their numbers are
// those of the command line is tested through Python, which calls the same functions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "poses.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

std::string shipped_file(const char* path) {
  return (std::filesystem::path(source_folder()) / path).string();
}

std::vector<double> column_of(const sf_table* table, std::string_view wanted) {
  std::size_t rows = 0, columns = 0;
  EXPECT_EQ(sf_table_size(table, &rows, &columns), SF_DONE);
  for (std::size_t i = 0; i < columns; ++i) {
    char name[64];
    EXPECT_EQ(sf_table_name(table, i, name, sizeof name, nullptr), SF_DONE);
    if (name != wanted) continue;
    std::vector<double> values(rows);
    EXPECT_EQ(sf_table_column(table, i, values.data(), rows, nullptr), SF_DONE);
    return values;
  }
  ADD_FAILURE() << "no column " << wanted;
  return {};
}

TEST(CInterfaceResults, APressInColumns) {
  sf_press_options options = {};
  options.size = sizeof options;
  options.rows = 3;
  options.depth_m = 0.9e-3;
  sf_table* table = nullptr;
  char error[256];
  const std::string finger = shipped_file("fingers/index.toml");
  ASSERT_EQ(sf_press(finger.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
  const std::vector<double> depths = column_of(table, "indentation_mm");
  ASSERT_EQ(depths.size(), 3u);
  EXPECT_NEAR(depths[1], 0.6, 1e-12);
  const std::vector<double> forces = column_of(table, "normal_force_N");
  EXPECT_GT(forces[0], 0.0);
  EXPECT_GT(forces[2], 2.0 * forces[1]);
  char text[16];
  std::size_t size = 0;
  ASSERT_EQ(sf_table_text(table, text, sizeof text, &size), SF_DONE);
  EXPECT_STREQ(text, "[{\"indentation_");
  EXPECT_GT(size, 500u);
  EXPECT_EQ(sf_table_name(table, 99, text, sizeof text, nullptr), SF_BAD_INPUT);
  sf_table_destroy(table);
  EXPECT_EQ(sf_table_size(table, &size, nullptr), SF_BAD_INPUT) << "it has ended";
  EXPECT_EQ(sf_table_size(nullptr, &size, nullptr), SF_BAD_INPUT);
}

TEST(CInterfaceResults, PressesThatAreRefused) {
  const std::string finger = shipped_file("fingers/index.toml");
  const auto refused = [&](auto&& spoil, const char* word) {
    sf_press_options options = {};
    options.size = sizeof options;
    spoil(options);
    sf_table* table = nullptr;
    char error[256] = "";
    EXPECT_EQ(sf_press(finger.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT);
    EXPECT_THAT(error, HasSubstr(word));
    EXPECT_EQ(table, nullptr);
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  refused([](auto& o) { o.size = 4; }, "size");
  refused([](auto& o) { o.rows = -1; }, "rows");
  refused([](auto& o) { o.depth_m = kNone; }, "depth_m");
  refused([](auto& o) { o.depth_m = 1.0; }, "depth_m");
  refused([](auto& o) { o.pitch_rad = 2.0; }, "pitch_rad");
  refused([](auto& o) { o.at_m[1] = kNone; }, "at_m");
  refused([](auto& o) { o.hold_s = 1.0; }, "hold_s");
  refused([](auto& o) { o.edge = 1, o.sphere_radius_m = 0.01; }, "edge");
}

TEST(CInterfaceResults, APressEndsWhereItIsToldToAndSaysHowFarItIs) {
  const std::string finger = shipped_file("fingers/index.toml");
  std::int32_t stop = 0;
  double progress = -1.0;
  sf_press_options options = {};
  options.rows = 2;
  options.depth_m = 0.2e-3;
  options.unload = 1;
  options.stop = &stop;
  options.progress = &progress;
  const auto press = [&](std::size_t size) {
    options.size = static_cast<std::uint32_t>(size);
    progress = -1.0;
    sf_table* table = nullptr;
    char error[256] = "";
    EXPECT_EQ(sf_press(finger.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
    const std::size_t rows = column_of(table, "normal_force_N").size();
    sf_table_destroy(table);
    return rows;
  };
  EXPECT_EQ(press(sizeof options), 4u);
  EXPECT_EQ(progress, 1.0);
  stop = 1;
  EXPECT_EQ(press(sizeof options), 1u);
  EXPECT_EQ(progress, 0.25);
  EXPECT_EQ(press(offsetof(sf_press_options, stop)), 4u) << "an older program has no such fields";
  EXPECT_EQ(progress, -1.0);
}

TEST(CInterfaceResults, AnEvaluationEndsWhereItIsToldTo) {
  const std::string scene = shipped_scene("plane.toml");
  const std::int32_t stop = 1;
  sf_evaluate_options options = {};
  options.size = sizeof options;
  options.stop = &stop;
  sf_table* table = nullptr;
  char error[256] = "";
  EXPECT_EQ(sf_evaluate(scene.c_str(), &options, &table, error, sizeof error), SF_FAILED);
  EXPECT_STRNE(error, "");
  options.stop = nullptr;
  options.objective = "beauty";
  EXPECT_EQ(sf_evaluate(scene.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("surface"));
  options.objective = nullptr;
  options.duration_s = -1.0;
  EXPECT_EQ(sf_evaluate(scene.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT);
  options.size = 0;
  EXPECT_EQ(sf_evaluate(scene.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT);
}

TEST(CInterfaceResults, AnEvaluationSaysHowFarItIsToWhoKnowsOfIt) {
  const std::string scene = shipped_scene("plane.toml");
  double progress = -1.0;
  sf_evaluate_options options = {};
  options.duration_s = 0.05;
  options.progress = &progress;
  for (const std::size_t size : {sizeof options, offsetof(sf_evaluate_options, progress)}) {
    options.size = static_cast<std::uint32_t>(size);
    progress = -1.0;
    sf_table* table = nullptr;
    char error[256] = "";
    ASSERT_EQ(sf_evaluate(scene.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
    EXPECT_EQ(column_of(table, "time_s").size(), 2u);
    if (size < sizeof options) {
      EXPECT_EQ(progress, -1.0) << "an older program has no such field";
    } else {
      EXPECT_NEAR(progress, 1.0, 0.3);
    }
    sf_table_destroy(table);
  }
}

TEST(CInterfaceResults, ARunIsRecordedAndReplays) {
  const TemporaryDirectory directory;
  const std::string scene = shipped_scene("plane.toml"), recording = directory / "run.sqlite";
  double progress = 0.0;
  sf_run_options options = {};
  options.size = sizeof options;
  options.recording = recording.c_str();
  options.duration_s = 0.3;
  options.progress = &progress;
  sf_table* table = nullptr;
  char error[256], text[4096], difference[256];
  ASSERT_EQ(sf_run(scene.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
  ASSERT_EQ(sf_table_text(table, text, sizeof text, nullptr), SF_DONE);
  EXPECT_THAT(text, HasSubstr("\"steps\": 300"));
  sf_table_destroy(table);
  EXPECT_GT(progress, 0.5);
  std::int32_t agree = 0;
  ASSERT_EQ(sf_recording_replay(recording.c_str(), &agree, difference, sizeof difference, error,
                                sizeof error),
            SF_DONE)
      << error;
  EXPECT_EQ(agree, 1) << difference;
  EXPECT_EQ(sf_run(scene.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT)
      << "the recording is there already";
  EXPECT_THAT(error, HasSubstr(recording));
}

TEST(CInterfaceResults, RunsThatAreRefused) {
  const std::string scene = shipped_scene("plane.toml");
  const auto refused = [&](const char* word, auto&& spoil) {
    sf_run_options options = {};
    options.size = sizeof options;
    spoil(options);
    sf_table* table = nullptr;
    char error[256] = "";
    EXPECT_EQ(sf_run(scene.c_str(), &options, &table, error, sizeof error), SF_BAD_INPUT) << word;
    EXPECT_THAT(error, HasSubstr(word));
    EXPECT_EQ(table, nullptr);
  };
  refused("sf_run_options.size", [](sf_run_options& o) { o.size = 8; });
  refused("threads", [](sf_run_options& o) { o.threads = 65; });
  refused("duration_s", [](sf_run_options& o) { o.duration_s = NAN; });
  refused("predict_s", [](sf_run_options& o) { o.predict_s = 1.0; });
  refused("record_state", [](sf_run_options& o) { o.record_state = 1; });
  refused("/no/such.toml", [](sf_run_options& o) { o.device = "/no/such.toml"; });
}

TEST(CInterfaceResults, FilesThatComeWithSoftfingerByName) {
  char file[512], error[256];
  std::size_t count = 0;
  ASSERT_EQ(sf_shipped_file("device", "membrane", file, sizeof file, &count, error, sizeof error),
            SF_DONE)
      << error;
  EXPECT_THAT(file, testing::EndsWith("devices/membrane.toml"));
  EXPECT_EQ(count, std::strlen(file) + 1);
  EXPECT_EQ(sf_shipped_file("finger", "a/b.toml", file, sizeof file, nullptr, nullptr, 0), SF_DONE);
  EXPECT_STREQ(file, "a/b.toml");
  EXPECT_EQ(sf_shipped_file("device", "membran", file, sizeof file, nullptr, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("which has membrane"));
  EXPECT_EQ(sf_shipped_file("toy", "ball", file, sizeof file, nullptr, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_STREQ(error, "what toy: there is scene, device, finger, study");
  EXPECT_EQ(sf_shipped_file(nullptr, nullptr, nullptr, 0, nullptr, nullptr, 0), SF_BAD_INPUT);
}

TEST(CInterfaceResults, AFingerIsFittedToAPress) {
  const TemporaryDirectory directory;
  const std::string curve = directory / "press.csv", out = directory / "mine.toml";
  const std::string finger = shipped_file("fingers/index.toml");
  sf_press_options press = {};
  press.size = sizeof press;
  press.rows = 5;
  press.depth_m = 0.8e-3;
  sf_table* table = nullptr;
  char error[256], text[4096];
  ASSERT_EQ(sf_press(finger.c_str(), &press, &table, error, sizeof error), SF_DONE) << error;
  const std::vector<double> depths = column_of(table, "indentation_mm");
  const std::vector<double> forces = column_of(table, "normal_force_N");
  sf_table_destroy(table);
  {
    std::ofstream file(curve);
    file << "indentation_mm,force_N\n";
    for (std::size_t i = 0; i < depths.size(); ++i) {
      file << depths[i] << ',' << (i % 2 == 0 ? 1.01 : 0.99) * forces[i] << '\n';
    }
  }
  sf_fit_options options = {};
  options.size = sizeof options;
  options.parameters = "youngs_modulus_kPa";
  options.out = out.c_str();
  ASSERT_EQ(sf_finger_fit(finger.c_str(), curve.c_str(), &options, &table, error, sizeof error),
            SF_DONE)
      << error;
  ASSERT_EQ(sf_table_text(table, text, sizeof text, nullptr), SF_DONE);
  sf_table_destroy(table);
  const nlohmann::json found = nlohmann::json::parse(text);
  const nlohmann::json& modulus = found.at("parameters").at("youngs_modulus_kPa");
  EXPECT_NEAR(modulus.at("value").get<double>(), 26.0, 1.0) << "that of the file";
  EXPECT_LT(modulus.at("ci95_low").get<double>(), 26.0);
  EXPECT_TRUE(std::filesystem::exists(out));
  EXPECT_EQ(sf_finger_fit(finger.c_str(), curve.c_str(), &options, &table, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("exists already"));
  std::filesystem::remove(out);
  const std::int32_t stop = 1;
  options.stop = &stop;
  EXPECT_EQ(sf_finger_fit(finger.c_str(), curve.c_str(), &options, &table, error, sizeof error),
            SF_FAILED);
  EXPECT_THAT(error, HasSubstr("was ended"));
  EXPECT_FALSE(std::filesystem::exists(out));
  options.stop = nullptr;
  options.out = nullptr;
  options.parameters = "beauty";
  EXPECT_EQ(sf_finger_fit(finger.c_str(), curve.c_str(), &options, &table, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("youngs_modulus_kPa, min, max"));
}

TEST(CInterfaceResults, ADeviceSolvesPosesAndMatches) {
  sf_device* device = nullptr;
  char error[256];
  ASSERT_EQ(sf_device_create(shipped_file("devices/thimble-3rrs.toml").c_str(), &device, error,
                             sizeof error),
            SF_DONE)
      << error;
  sf_device_info info = {sizeof info, 0, 0, 1};
  ASSERT_EQ(sf_device_describe(device, &info), SF_DONE);
  EXPECT_EQ(info.configuration_count, 3u);
  EXPECT_EQ(info.joint_count, 3u);
  EXPECT_EQ(info.joints_are_linear, 0);
  const double q[3] = {0.1, -0.05, 1e-3};
  double joints[3], back[3];
  std::int32_t closes = 0, reachable = 0;
  ASSERT_EQ(sf_device_solve(device, q, 3, joints, 3, &closes, &reachable), SF_DONE);
  EXPECT_EQ(closes, 1);
  EXPECT_EQ(reachable, 1);
  ASSERT_EQ(sf_device_pose(device, joints, 3, back, 3), SF_DONE);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], q[i], 1e-9);
  // A plane of skin 2 mm under home, tipped: the platform lies on it.
  std::vector<double> points;
  std::vector<std::uint8_t> touches;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      points.insert(points.end(), {2e-3 + 1e-3 * i, 1e-3 * j, -8e-3 - 0.05e-3 * i});
      touches.push_back(1);
    }
  }
  sf_points given = {};
  given.size = sizeof given;
  given.count = 25;
  given.points_F_m = points.data();
  given.in_contact = touches.data();
  sf_match match = {};
  match.size = sizeof match;
  ASSERT_EQ(sf_device_match(device, &given, &match), SF_DONE);
  sf_match older = match;  // as programs had it that were built before
  older.size = offsetof(sf_match, at_limit);
  std::memset(older.at_limit, 'x', sizeof older.at_limit);
  EXPECT_EQ(sf_device_match(device, &given, &older), SF_DONE);
  EXPECT_EQ(older.deviation_m2, match.deviation_m2);
  EXPECT_EQ(older.at_limit[0], 'x') << "nothing is written beyond its size";
  sf_points published = given;
  published.objective = 1;
  EXPECT_EQ(sf_device_match(device, &published, &older), SF_BAD_INPUT) << "limits inside";
  published.limits = 1;
  EXPECT_EQ(sf_device_match(device, &published, &older), SF_DONE);
  published.objective = 3;
  EXPECT_EQ(sf_device_match(device, &published, &older), SF_BAD_INPUT);
  EXPECT_LT(match.deviation_m2, 1e-12);
  EXPECT_NEAR(match.configuration[0], std::atan(0.05), 1e-3);
  points[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sf_device_match(device, &given, &match), SF_BAD_INPUT);
  char line[128];
  sf_device_message(device, line, sizeof line);
  EXPECT_THAT(line, HasSubstr("points_F_m"));
  given.count = 0;
  EXPECT_EQ(sf_device_match(device, &given, &match), SF_BAD_INPUT);
  EXPECT_EQ(sf_device_solve(device, q, 2, joints, 3, nullptr, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_device_solve(device, q, 3, joints, 2, nullptr, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_device_pose(device, nullptr, 3, back, 3), SF_BAD_INPUT);
  EXPECT_EQ(sf_device_component(device, 3, line, sizeof line, nullptr), SF_BAD_INPUT);
  sf_device_destroy(device);
  EXPECT_EQ(sf_device_describe(device, &info), SF_BAD_INPUT);
  EXPECT_EQ(sf_device_create("/no/such.toml", &device, error, sizeof error), SF_BAD_INPUT);
}

TEST(CInterfaceResults, ARecordingIsExportedAndReplayed) {
  const TemporaryDirectory directory;
  const std::string recording = directory / "run.sqlite";
  sf_options options = {};
  options.size = sizeof options;
  options.recording = recording.c_str();
  {
    const OpenedScene scene("plane.toml", &options);
    for (int i = 0; i <= 300; ++i) {
      const sf_pose X_WFt = touching_pose(1e-3 * i);
      ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 1e-3 * i, nullptr), SF_DONE);
    }
  }
  std::int32_t agree = 0;
  char text[256], error[256];
  ASSERT_EQ(sf_recording_replay(recording.c_str(), &agree, text, sizeof text, error, sizeof error),
            SF_DONE)
      << error;
  EXPECT_EQ(agree, 1) << text;
  const std::string folder = directory / "csv";
  ASSERT_EQ(sf_recording_export(recording.c_str(), folder.c_str(), text, sizeof text, error,
                                sizeof error),
            SF_DONE)
      << error;
  EXPECT_STREQ(text, "") << "it is complete";
  EXPECT_TRUE(std::filesystem::exists(folder + "/contact.csv"));
  EXPECT_EQ(sf_recording_export(recording.c_str(), folder.c_str(), text, sizeof text, error,
                                sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("exist"));
  for (const char* name : {"run.h5", "run.mcap"}) {
    const std::string file = directory / name;
    EXPECT_EQ(sf_recording_export(recording.c_str(), file.c_str(), text, sizeof text, error,
                                  sizeof error),
              SF_DONE)
        << error;
    EXPECT_GT(std::filesystem::file_size(file), 50'000U) << name;
  }
  EXPECT_EQ(sf_recording_replay("/no/such.sqlite", &agree, text, sizeof text, nullptr, 0),
            SF_BAD_INPUT);
}

std::string text_of(const sf_table* table) {
  std::size_t size = 0;
  EXPECT_EQ(sf_table_text(table, nullptr, 0, &size), SF_DONE);
  std::string text(size, '\0');
  EXPECT_EQ(sf_table_text(table, text.data(), size, nullptr), SF_DONE);
  text.resize(size - 1);
  return text;
}

TEST(CInterfaceResults, ColumnsOfARecordingWithTheirUnits) {
  const TemporaryDirectory directory;
  const std::string scene = shipped_file("scenes/plane.toml"), recording = directory / "run.sqlite";
  sf_run_options options = {};
  options.size = sizeof options;
  options.recording = recording.c_str();
  options.duration_s = 0.2;
  sf_table* table = nullptr;
  char error[512];
  ASSERT_EQ(sf_run(scene.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
  sf_table_destroy(table);

  ASSERT_EQ(sf_recording_table(recording.c_str(), "bone", nullptr, &table, error, sizeof error),
            SF_DONE)
      << error;
  const std::vector<double> times = column_of(table, "time_s");
  ASSERT_EQ(times.size(), 201u) << "where it starts, and each step";
  EXPECT_NEAR(times.back(), 0.2, 1e-12);
  char unit[16];
  ASSERT_EQ(sf_table_unit(table, 0, unit, sizeof unit, nullptr), SF_DONE);
  EXPECT_STREQ(unit, "s");
  ASSERT_EQ(sf_table_unit(table, 1, unit, sizeof unit, nullptr), SF_DONE);
  EXPECT_STREQ(unit, "mm");
  EXPECT_EQ(sf_table_unit(table, 99, unit, sizeof unit, nullptr), SF_BAD_INPUT);
  const auto about = nlohmann::json::parse(text_of(table));
  EXPECT_EQ(about.at("note"), "");
  EXPECT_THAT(about.at("tables").get<std::vector<std::string>>(),
              testing::IsSupersetOf({"bone", "command", "contact", "pose"}));
  sf_table_destroy(table);

  // Words are numbered.
  ASSERT_EQ(sf_recording_table(recording.c_str(), "command", nullptr, &table, error, sizeof error),
            SF_DONE)
      << error;
  std::size_t columns = 0;
  ASSERT_EQ(sf_table_size(table, nullptr, &columns), SF_DONE);
  ASSERT_EQ(sf_table_unit(table, columns - 1, unit, sizeof unit, nullptr), SF_DONE);
  EXPECT_STREQ(unit, "");
  char word[32];
  ASSERT_EQ(sf_table_word(table, columns - 1, 0, word, sizeof word, nullptr), SF_DONE);
  EXPECT_STREQ(word, "homing");
  EXPECT_EQ(column_of(table, "state").front(), 0.0);
  EXPECT_EQ(sf_table_word(table, columns - 1, 99, word, sizeof word, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_table_word(table, 0, 0, word, sizeof word, nullptr), SF_BAD_INPUT) << "numbers";
  sf_table_destroy(table);

  EXPECT_EQ(sf_recording_table(recording.c_str(), "beauty", nullptr, &table, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("table beauty: there is bone, command"));
  EXPECT_EQ(table, nullptr);
}

TEST(CInterfaceResults, AHostEndsWhatIsDoneWithARecording) {
  const TemporaryDirectory directory;
  const std::string scene = shipped_file("scenes/plane.toml"), recording = directory / "run.sqlite";
  sf_run_options options = {};
  options.size = offsetof(sf_run_options, tracker);  // as programs had it that were built before
  options.recording = recording.c_str();
  options.duration_s = 0.3;
  sf_table* table = nullptr;
  char error[512];
  ASSERT_EQ(sf_run(scene.c_str(), &options, &table, error, sizeof error), SF_DONE) << error;
  sf_table_destroy(table);
  const std::int32_t stop = 1;
  sf_watch watch = {};
  watch.size = sizeof watch;
  watch.stop = &stop;
  for (const char* to : {"csv", "run.h5", "run.mcap"}) {
    const std::string file = directory / to;
    EXPECT_EQ(sf_export(recording.c_str(), file.c_str(), &watch, nullptr, 0, error, sizeof error),
              SF_FAILED);
    EXPECT_THAT(error, HasSubstr("ended before it was done"));
    EXPECT_FALSE(std::filesystem::exists(file)) << file;
  }
  EXPECT_EQ(sf_recording_table(recording.c_str(), "pose", &watch, &table, error, sizeof error),
            SF_FAILED);
  sf_replay_options again = {};
  again.size = sizeof again;
  again.stop = &stop;
  EXPECT_EQ(sf_replay(recording.c_str(), &again, &table, error, sizeof error), SF_FAILED);
  again.stop = nullptr;
  volatile double progress = 0.0;
  again.progress = &progress;
  ASSERT_EQ(sf_replay(recording.c_str(), &again, &table, error, sizeof error), SF_DONE) << error;
  EXPECT_EQ(nlohmann::json::parse(text_of(table)).at("agree"), true);
  EXPECT_GT(progress, 0.9);
  sf_table_destroy(table);
}

}  // namespace
}  // namespace softfinger
