// Whatever a table of fields names is written, read, compared and exported; and every member of a
// record is in its table.
#include "softfinger/recording/record_fields.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/csv_export.hpp"
#include "softfinger/recording/recording_layout.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/recording/sqlite_database.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// Gives each field it meets a value that none had before.
struct Filler {
  std::int64_t count = 40;

  void fill(double& value) { value = 0.125 * static_cast<double>(++count); }
  void fill(std::integral auto& value) {
    value = static_cast<std::remove_reference_t<decltype(value)>>(++count);
  }
  void fill(bool& value) { value = !value; }
  void fill(Vector3& vector) {
    for (double& value : vector) fill(value);
  }
  void fill(StoredPose& pose) {
    fill(pose.translation);
    for (double& value : pose.rotation.coeffs()) fill(value);
  }
  void fill(Configuration& numbers) {
    numbers.resize(2);
    for (double& value : numbers) fill(value);
  }
  void fill(DeviceState& state) {
    state = state == DeviceState::kRendering ? DeviceState::kHolding : DeviceState::kRendering;
  }
  void fill(Targets<FormedCommand> targets) {
    targets.command.servos = 2;
    for (std::size_t i = 0; i < 2; ++i) fill(targets.command.targets[i]);
  }
};

/// The numbers of a field, one a column.
std::vector<double> numbers(double value) { return {value}; }
std::vector<double> numbers(std::integral auto value) { return {static_cast<double>(value)}; }
std::vector<double> numbers(DeviceState state) { return {static_cast<double>(state)}; }
std::vector<double> numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> numbers(const Configuration& q) { return {q.begin(), q.end()}; }
std::vector<double> numbers(const StoredPose& pose) {
  const auto& [p, q] = std::tie(pose.translation, pose.rotation);
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}
std::vector<double> numbers(Targets<const FormedCommand> targets) {
  const auto& all = targets.command.targets;
  return {all.begin(), all.begin() + targets.command.servos};
}

template <typename Fields, typename Record>
void fill(Fields fields, Record& record) {
  Filler filler;
  for_each_field(fields, [&](const auto& field) { filler.fill(field.of(record)); });
  record.step = 7;
  record.finger = 1;
}

StepRecord filled_step() {
  StepRecord step;
  step.tracked.valid = false;  // is flipped
  fill(kStepFields, step);
  return step;
}

TickRecord filled_tick() {
  TickRecord tick;
  fill(kTickFields, tick);
  return tick;
}

class RecordFields : public testing::Test {
 protected:
  void SetUp() override {
    RecordingInfo info;
    info.simulation_rate = 1000.0;
    for (const char* name : {"thumb", "index"}) {
      info.fingers.push_back({.name = name,
                              .model = "/somewhere/finger.toml",
                              .device = "/somewhere/device.toml",
                              .tracker = "script",
                              .configuration_names = {"pitch_deg", "travel_mm"},
                              .joints = 2,
                              .device_rate = 30.0});
    }
    RecordingWriter writer(file_, info, RecordingWriter::WhenFull::kWait, StepRecord{});
    writer.push(filled_tick());
    writer.push(filled_step());
    writer.close();
  }

  StepRecord read_step() {
    StepRecord step;
    EXPECT_TRUE(RecordingReader(file_).next(step));
    return step;
  }

  TickRecord read_tick() {
    TickRecord tick;
    EXPECT_TRUE(RecordingReader(file_).next(tick));
    return tick;
  }

  /// As a program that did not know the newer fields wrote it.
  void forget_newer_fields() {
    SqliteDatabase database(file_, SqliteDatabase::Mode::kCreate);
    const auto forget_in = [&](const char* table, auto fields) {
      for_each_field(fields, [&](const auto& field) {
        if (!field.use.newer) return;
        for (const std::string& column : RecordFields::fields(field.use.columns)) {
          database.execute(fmt::format("alter table {} drop column {}", table, column).c_str());
        }
      });
    };
    forget_in("steps", kStepFields);
    forget_in("ticks", kTickFields);
  }

  /// The one row of an exported file, by the names of its columns.
  std::map<std::string, std::string> row(const fs::path& csv) {
    std::ifstream stream(csv);
    std::string header, values;
    EXPECT_TRUE(std::getline(stream, header) && std::getline(stream, values)) << csv;
    std::map<std::string, std::string> result;
    const std::vector<std::string> names = fields(header), texts = fields(values);
    EXPECT_EQ(names.size(), texts.size()) << csv;
    for (std::size_t i = 0; i < names.size(); ++i) result[names[i]] = texts[i];
    return result;
  }

  static std::vector<std::string> fields(std::string_view line) {
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

  /// Fields of `record` that have columns of their own, as they stand in the CSV.
  template <typename Fields, typename Record>
  void expect_exported(Fields table, const Record& record, const fs::path& directory) {
    static const std::map<CsvFile, const char*> kNames = {
        {CsvFile::kPose, "pose.csv"},       {CsvFile::kBone, "bone.csv"},
        {CsvFile::kContact, "contact.csv"}, {CsvFile::kTiming, "timing.csv"},
        {CsvFile::kForce, "force.csv"},     {CsvFile::kConfiguration, "configuration.csv"},
        {CsvFile::kJoints, "joints.csv"},   {CsvFile::kCommand, "command.csv"}};
    for_each_field(table, [&](const auto& field) {
      const auto& place = field.use.csv;
      if (place.columns.empty()) return;
      const auto found = row(directory / kNames.at(place.file));
      const std::vector<std::string> columns = fields(place.columns);
      const std::vector<double> expected = numbers(field.of(record));
      ASSERT_EQ(columns.size(), expected.size()) << place.columns;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        ASSERT_TRUE(found.contains(columns[i])) << columns[i];
        const std::string& text = found.at(columns[i]);
        if (columns[i] == "state") {
          EXPECT_EQ(text, "rendering");
        } else {
          const double value = std::stod("0" + text) * unit_scale(columns[i]);
          EXPECT_NEAR(value, expected[i], 1e-9 * expected[i]) << columns[i];
        }
      }
    });
  }

  TemporaryDirectory directory_;
  fs::path file_ = directory_ / "run.db";
};

TEST_F(RecordFields, EachGoesRound) {
  const StepRecord step = filled_step();
  const StepRecord read = read_step();
  for_each_field(kStepFields, [&](const auto& field) {
    EXPECT_EQ(numbers(field.of(read)), numbers(field.of(step))) << field.use.columns;
  });
  EXPECT_EQ(first_difference(step, read), nullptr);

  const TickRecord tick = filled_tick();
  const TickRecord read_tick = this->read_tick();
  for_each_field(kTickFields, [&](const auto& field) {
    EXPECT_EQ(numbers(field.of(read_tick)), numbers(field.of(tick))) << field.use.columns;
  });
  EXPECT_EQ(first_difference(tick, read_tick), nullptr);
}

TEST_F(RecordFields, EachIsExportedInItsUnit) {
  static_cast<void>(export_csv(file_, directory_ / "csv"));
  expect_exported(kStepFields, filled_step(), directory_ / "csv");
  expect_exported(kTickFields, filled_tick(), directory_ / "csv");
}

template <typename Fields, typename Record>
void expect_changes_told(Fields fields, const Record& record) {
  for_each_field(fields, [&](const auto& field) {
    Record changed = record;
    Filler{.count = 1000}.fill(field.of(changed));
    const char* difference = first_difference(record, changed);
    if (field.use.part == RecordPart::kNotCompared) {
      EXPECT_EQ(difference, nullptr) << field.use.columns;
    } else {
      EXPECT_STREQ(difference, kRecordPartNames[static_cast<std::size_t>(field.use.part)])
          << field.use.columns;
    }
  });
}

TEST(RecordField, ChangeOfEachIsToldByThePartItBelongsTo) {
  expect_changes_told(kStepFields, filled_step());
  expect_changes_told(kTickFields, filled_tick());
}

TEST(RecordField, PartsAreToldInOrder) {
  const StepRecord step = filled_step();
  StepRecord changed = step;
  ++changed.hash;
  EXPECT_STREQ(first_difference(step, changed), "state, configuration or command");
  changed.residual += 1.0;
  EXPECT_STREQ(first_difference(step, changed), "solution");
  changed.normal_force_sum += 1.0;
  EXPECT_STREQ(first_difference(step, changed), "contact");
}

TEST(RecordField, EachLiveOneIsSentInItsUnit) {
  std::map<std::string_view, double> expected;
  const StepRecord step = filled_step();
  for_each_field(kStepFields, [&](const auto& field) {
    if (field.use.live.empty()) return;
    const std::vector<double> values = numbers(field.of(step));
    ASSERT_EQ(values.size(), 1U) << field.use.live;
    expected[field.use.live] = values[0] / unit_scale(field.use.live);
  });
  std::map<std::string_view, double> sent;
  for_each_live_field(step, [&](std::string_view name, double value) { sent[name] = value; });
  EXPECT_EQ(sent, expected);
}

/// Stands for a member of any type.
struct Anything {
  template <typename Member>
  operator Member() const;  // NOLINT(google-explicit-constructor)
};

/// How many members a record has.
template <typename Record, typename... Known>
constexpr std::size_t member_count() {
  if constexpr (requires { Record{Known{}..., Anything{}}; }) {
    return member_count<Record, Known..., Anything>();
  } else {
    return sizeof...(Known);
  }
}

/// How many of them are, or have in them, a field of the table.
template <typename Record, typename Fields>
std::size_t members_in(Fields fields) {
  const Record record;
  std::set<const void*> members;
  for_each_field(
      fields, [&]<auto First, auto... Rest>(const Field<Record, First, Rest...>&) {
        members.insert(&std::invoke(First, record));
      });
  return members.size();
}

TEST(RecordField, NoMemberIsLeftOut) {
  EXPECT_EQ(members_in<StepRecord>(kStepFields) + 2,
            member_count<StepRecord>() - 1 + member_count<ContactSums>())
      << "all but nodes_W and samples, which have a table of their own";
  EXPECT_EQ(members_in<TickRecord>(kTickFields) + 1, member_count<TickRecord>())
      << "all but stages, which belong to what was sent last";
}

TEST_F(RecordFields, RecordingThatLacksTheNewerOnesIsReadComparedAndExported) {
  forget_newer_fields();
  const auto expect_unknown = [](auto fields, const auto& record) {
    for_each_field(fields, [&](const auto& field) {
      if (!field.use.newer) return;
      for (const double number : numbers(field.of(record))) {
        EXPECT_TRUE(std::isnan(number)) << field.use.columns;
      }
    });
  };
  expect_unknown(kStepFields, read_step());
  expect_unknown(kTickFields, read_tick());
  EXPECT_EQ(first_difference(read_step(), filled_step()), nullptr);
  EXPECT_EQ(first_difference(read_tick(), filled_tick()), nullptr);
  static_cast<void>(export_csv(file_, directory_ / "csv"));
  const auto contact = row(directory_ / "csv/contact.csv");
  EXPECT_EQ(contact.at("normal_force_sum_N"), "");
  EXPECT_EQ(contact.at("tangential_y_N"), "");
  EXPECT_NE(contact.at("stuck_fraction"), "");
}

TEST_F(RecordFields, RecordingThatLacksAnotherIsRefused) {
  SqliteDatabase(file_, SqliteDatabase::Mode::kCreate)
      .execute("alter table steps drop column slip_ratio");
  EXPECT_THROW(RecordingReader{file_}, InputError);
}

/// What every recording of this format has.
template <typename Fields>
std::string first_columns(Fields fields) {
  std::string columns;
  bool more_follow = true;
  for_each_field(fields, [&](const auto& field) {
    more_follow = more_follow && !field.use.newer;
    EXPECT_NE(more_follow, field.use.newer) << field.use.columns << " is not last, or not newer";
    if (more_follow) columns += fmt::format("{},", field.use.columns);
  });
  return columns;
}

TEST(RecordField, ColumnsOfTheFormatKeepTheirPlacesAndOthersAreNewer) {
  EXPECT_EQ(first_columns(kStepFields),
            "step,finger,time_s,x_m,y_m,z_m,qw,qx,qy,qz,tracked_time_s,valid,bone_x_m,bone_y_m,"
            "bone_z_m,bone_qw,bone_qx,bone_qy,bone_qz,contact_samples,contact_area_m2,"
            "normal_force_N,tangential_force_N,slip_ratio,stuck_fraction,centroid_x_m,centroid_y_m,"
            "centroid_z_m,normal_x,normal_y,normal_z,least_gap_m,iterations,converged,residual,"
            "tick,hash,cpu_s,wall_s,");
  EXPECT_EQ(first_columns(kTickFields),
            "step,finger,tick,time_s,tracked,emergency,measured_force_N,measured_at,wanted,"
            "deviation_m2,iterations,travel_offset_m,ceiling,configuration,joints_rad,servo_us,"
            "state,hash,cpu_s,latency_s,");
}

TEST_F(RecordFields, BetterNamesHaveTheSameContent) {
  SqliteDatabase database(file_, SqliteDatabase::Mode::kRead);
  SqliteStatement rows(database, "select joints, joints_rad, set_points, servo_us from ticks");
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.bytes(0).size(), 2 * sizeof(double));
  EXPECT_EQ(rows.bytes(0), rows.bytes(1));
  EXPECT_EQ(rows.bytes(2).size(), 2 * sizeof(double));
  EXPECT_EQ(rows.bytes(2), rows.bytes(3));
}

}  // namespace
}  // namespace softfinger
