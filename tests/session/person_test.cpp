// What is known of a person: their file, and that a run with it has the bits of one whose finger
// and poses are theirs already.
#include "softfinger/person/person.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "../support/table_rest.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/tracking/csv_tracker.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

class PersonFile : public testing::Test {
 protected:
  Person load(const std::string& text) {
    std::ofstream(file_) << text;
    return load_person(file_);
  }
  std::string refusal(const std::string& text) {
    try {
      (void)load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing refused";
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "anna.toml";
};

TEST_F(PersonFile, ComesBackAsItWasSaved) {
  const Pose X_BodyFt{exp_rotation({0.1, -2.0, 0.7}), {-12.3456 * mm, 0.0, 1.0 / 3.0 * mm}};
  Person person = load_person_if_any(file_);
  EXPECT_TRUE(person.fingers.empty());
  person.at("index").X_BodyFt = X_BodyFt;
  person.at("thumb").size.breadth = 21.7 * mm;
  save_person(person);
  const Person read = load_person(file_);
  ASSERT_EQ(read.fingers.size(), 2U);
  EXPECT_TRUE(read.find("index")->X_BodyFt->translation.isApprox(X_BodyFt.translation, 1e-6));
  EXPECT_TRUE(read.find("index")->X_BodyFt->rotation.isApprox(X_BodyFt.rotation, 1e-6));
  EXPECT_FALSE(read.find("index")->size.length);
  EXPECT_DOUBLE_EQ(read.find("thumb")->size.breadth.value(), 21.7 * mm);
  EXPECT_FALSE(read.find("thumb")->X_BodyFt);
  EXPECT_EQ(read.find("ring"), nullptr);
}

TEST_F(PersonFile, WhatIsNotOfTheChangedFingerStays) {
  Person person = load(
      "[middle.size]\nlength_mm = 26.1\nbreadth_mm = 17.3\n"
      "[index.size]\ndepth_mm = 13\n[ring]\n"
      "[index.registration]\ntranslation_mm = [1, 2, 3]\nrotation_vector_deg = [0.1, 0.2, 0.3]\n");
  person.at("index").X_BodyFt = Pose{};
  save_person(person);
  EXPECT_EQ(read_text_file(file_, 10000),
            "[middle.size]\nlength_mm = 26.1\nbreadth_mm = 17.3\n"
            "[index.size]\ndepth_mm = 13\n[ring]\n"
            "[index.registration]\ntranslation_mm = [0, 0, 0]\nrotation_vector_deg = [0, 0, 0]\n");
  // Nothing is left beside it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file_.parent_path()), {}), 1);
}

TEST_F(PersonFile, CommentsAndLayoutStay) {
  Person person = load(
      "# Anna, right hand\n"
      "[index.size]   # by calliper\n"
      "length_mm = 25.0  # from the crease\n"
      "# breadth_mm = 16.0\n"
      "\n"
      "[ middle . mount ]\n"
      "translation_mm = [\n  1, # x\n  2,\n  3 ]  # the old strap\n"
      "rotation_vector_deg = [0, 0, 0]\n");
  person.at("index").size.length = 26.0 * mm;
  person.at("index").size.depth = 13.5 * mm;
  person.at("index").modulus_factor = 1.25;
  person.at("middle").mount->translation.x() = 1.5 * mm;
  person.at("thumb").mount = Pose{};
  save_person(person);
  EXPECT_EQ(read_text_file(file_, 10000),
            "# Anna, right hand\n"
            "[index.size]   # by calliper\n"
            "length_mm = 26  # from the crease\n"
            "# breadth_mm = 16.0\n"
            "depth_mm = 13.5\n"
            "\n[index.tissue]\nmodulus_factor = 1.25\n"
            "\n"
            "[ middle . mount ]\n"
            "translation_mm = [1.5, 2, 3]  # the old strap\n"
            "rotation_vector_deg = [0, 0, 0]\n"
            "\n[thumb.mount]\ntranslation_mm = [0, 0, 0]\nrotation_vector_deg = [0, 0, 0]\n");
}

// A program's words for what is not written the usual way: all is written anew.
TEST_F(PersonFile, NothingIsLostWhereTheFileIsWrittenAnotherWay) {
  Person person = load("index = {size = {length_mm = 25.0}}\n[ring.size]\ndepth_mm = 12\n");
  person.at("index").size.length = 26.0 * mm;
  save_person(person);
  const Person read = load_person(file_);
  EXPECT_DOUBLE_EQ(read.find("index")->size.length.value(), 26.0 * mm);
  EXPECT_DOUBLE_EQ(read.find("ring")->size.depth.value(), 12.0 * mm);
}

TEST_F(PersonFile, IsItsOwnersAloneAndNoPlantedLinkIsFollowed) {
  const std::filesystem::path other = file_.parent_path() / "other";
  std::ofstream(other) << "of somebody else";
  std::filesystem::create_symlink(other, file_.string() + "." + std::to_string(::getpid()));
  Person person = load("[index.size]\ndepth_mm = 13\n");
  save_person(person);
  EXPECT_EQ(read_text_file(other, 100), "of somebody else");
  EXPECT_EQ(std::filesystem::status(file_).permissions(), std::filesystem::perms{0600});
}

TEST_F(PersonFile, WhatItDoesNotKnowIsRefusedByName) {
  EXPECT_THAT(refusal("[index.sise]\nlength_mm = 20\n"), HasSubstr("anna.toml:1: index.sise"));
  EXPECT_THAT(refusal("[index.size]\nlength_cm = 2\n"), HasSubstr("length_mm"));
  EXPECT_THAT(refusal("[index.size]\nlength_mm = 0.1\n"), HasSubstr("at least 1"));
  EXPECT_THAT(refusal("[index.registration]\ntranslation_mm = [0, 0, 0]\n"),
              HasSubstr("rotation_vector_deg"));
  EXPECT_THAT(refusal("[index.registration]\ntranslation_mm = [0, 0, 900]\n"
                      "rotation_vector_deg = [0, 0, 0]\n"),
              HasSubstr("translation_mm"));
  EXPECT_THAT(refusal("[index.tissue]\nmodulus_factor = 0\n"), HasSubstr("modulus_factor"));
  EXPECT_THAT(refusal("[index.mount]\ntranslation_mm = [0, 0, 25]\n"), HasSubstr("translation_mm"));
  EXPECT_THAT(refusal("index = 3\n"), HasSubstr("index"));
  EXPECT_THAT(refusal("[\"a b\"]\n"), HasSubstr("no name of a finger"));
  EXPECT_THROW((void)load_person(directory_ / "nobody.toml"), InputError);
}

/// A person who lies on a table 50 mm up, with a body on the finger.
class PersonOnATable : public PersonFile {
 protected:
  static std::filesystem::path finger(const char* name) {
    return std::filesystem::path(source_folder()) / "fingers" / name;
  }
  /// Long, slender and flat.
  const std::shared_ptr<const FingerModel> true_finger_ = FingerModel::load(
      finger("index.toml"), {.length = 28 * mm, .breadth = 15 * mm, .depth = 12.5 * mm});
  const Pose X_BodyFt_{exp_rotation({0.2, 1.3, -0.4}), {3 * mm, 1 * mm, -14 * mm}};
  const std::vector<PostureCapture> captures_ = captures_of(*true_finger_, X_BodyFt_, 50 * mm);
  const RegistrationTask task_{
      .finger = "index", .model = finger("index.toml"), .measured = {}, .table_height = 50 * mm};
};

TEST_F(PersonOnATable, HowTheFingerLayComesBackAndCommentsStay) {
  Person person = load("[index.size]\ndepth_mm = 13  # by calliper\n");
  (void)register_person(person, task_, captures_);
  save_person(person);
  Person read = load_person(file_);
  const TableRest& rest = read.find("index")->on_table.value();
  ASSERT_EQ(rest.captures.size(), captures_.size());
  for (std::size_t k = 0; k < captures_.size(); ++k) {
    EXPECT_EQ(rest.captures[k].posture, captures_[k].posture);
    EXPECT_LT((rest.captures[k].up_Body - captures_[k].up_Body).norm(), 2e-6);
    EXPECT_NEAR(rest.captures[k].height, captures_[k].height, 1e-9);
  }
  EXPECT_TRUE(rest.height_was_given);
  EXPECT_NEAR(rest.height, 50 * mm, 1e-9);
  const std::string text = read_text_file(file_, 10000);
  EXPECT_THAT(text, HasSubstr("# by calliper\n"));
  save_person(read);
  EXPECT_EQ(read_text_file(file_, 10000), text);
}

TEST_F(PersonOnATable, WhoseSizeIsKnownLaterHasTheBodyWhereItIs) {
  for (const bool given : {true, false}) {
    RegistrationTask task = task_;
    if (!given) task.table_height.reset();
    Person person = load_person_if_any(file_);
    (void)register_person(person, task, captures_);
    PersonFinger& finger = person.at("index");
    const double before = (finger.X_BodyFt->translation - X_BodyFt_.translation).norm();
    EXPECT_GT(before, 0.2 * mm);
    finger.size = finger_size(*true_finger_);
    const Registration found = register_again(finger, this->finger("index.toml")).value();
    EXPECT_EQ(finger.X_BodyFt->translation, found.X_BodyFt.translation);
    const double after = (finger.X_BodyFt->translation - X_BodyFt_.translation).norm();
    EXPECT_LT(after, 1e-8) << given;
    EXPECT_NEAR(finger.on_table->height, 50 * mm, 1e-8);
  }
}

TEST_F(PersonOnATable, WhoWasNeverThereStaysAsItIs) {
  PersonFinger finger{.name = "index", .X_BodyFt = X_BodyFt_};
  EXPECT_FALSE(register_again(finger, this->finger("index.toml")));
  EXPECT_EQ(finger.X_BodyFt->translation, X_BodyFt_.translation);
}

TEST_F(PersonOnATable, SizesThatADeviceHasLearnedStand) {
  Person person = load_person_if_any(file_);
  person.at("index").size = finger_size(*true_finger_);
  person.at("index").mount = Pose{};
  (void)register_person(person, task_, captures_);
  EXPECT_EQ(person.find("index")->size.length, finger_size(*true_finger_).length);
  person.at("index").mount.reset();
  (void)register_person(person, task_, captures_);
  EXPECT_NE(person.find("index")->size.length, finger_size(*true_finger_).length);
}

TEST_F(PersonOnATable, WhatNobodyLaySoIsRefusedByName) {
  const std::string poses =
      "[index.registration]\ntranslation_mm = [0, 0, 0]\nrotation_vector_deg = [0, 0, 0]\n";
  const std::string up = "up = [0, 0, 1, 0, -1, 0, 0, 1, 0, -1, 0, 0, 0, 0, 1]\n";
  const std::string heights = "height_mm = [7, 8, 8, 12, 7]\n";
  const std::string table = "table_mm = 0\n";
  EXPECT_TRUE(load(poses + up + heights + table).find("index")->on_table);
  EXPECT_THAT(refusal(poses + up + heights), HasSubstr("table_mm"));
  EXPECT_THAT(refusal(poses + up + table), HasSubstr("height_mm"));
  EXPECT_THAT(refusal(poses + heights + table), HasSubstr("up: missing"));
  EXPECT_THAT(refusal(poses + "up = [0, 0, 1]\n" + heights + table), HasSubstr("up"));
  EXPECT_THAT(refusal(poses + up + "height_mm = [7, 8, 8, 12, 70000]\n" + table),
              HasSubstr("height_mm"));
  EXPECT_THAT(
      refusal(poses + "up = [0, 0, 1, 0, -1, 0, 0, 0.9, 0, -1, 0, 0, 0, 0, 1]\n" + heights + table),
      HasSubstr("direction 3 of 5"));
}

/// Runs of scenes/plane.toml whose tracker is a file of poses.
class PersonRun : public testing::Test {
 protected:
  PersonRun() {
    std::ofstream csv(directory_ / "body.csv");
    csv << "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (int i = 0; i <= 30; ++i) {
      const double down = std::min(i, 20) * 0.3;
      csv << fmt::format("{},{},5,{},{},0,0,{}\n", 0.02 * i, 0.1 * i, 20.0 - down, std::cos(0.35),
                         std::sin(0.35));
    }
    std::ofstream(person_) << "[index.size]\nlength_mm = 23\nbreadth_mm = 19\ndepth_mm = 15\n"
                              "[index.registration]\ntranslation_mm = [1.5, -2, -8]\n"
                              "rotation_vector_deg = [3, 8, -20]\n"
                              "[ring.size]\nlength_mm = 20\n";
  }
  RunOptions options(const char* recording) const {
    RunOptions options;
    options.scene = scenes_.scene("plane");
    options.trackers = {"csv:" + (directory_ / "body.csv").string()};
    options.as_fast_as_possible = true;
    options.person = person_;
    options.recording = directory_ / recording;
    return options;
  }
  static void run(const RunOptions& options) {
    const std::atomic<bool> stop{false};
    run_headless(options, stop);
  }
  /// scenes/plane.toml with a finger file of the person's size.
  [[nodiscard]] std::filesystem::path sized_scene() const {
    const std::filesystem::path fingers = std::filesystem::path(source_folder()) / "fingers";
    std::string finger = read_text_file(fingers / "index.toml", 100000);
    finger.replace(finger.find("index.msh"), 9, (fingers / "index.msh").string());
    std::ofstream(directory_ / "sized.toml")
        << finger << "\n[size]\nlength_mm = 23\nbreadth_mm = 19\ndepth_mm = 15\n";
    std::string scene = read_text_file(scenes_.scene("plane"), 100000);
    const std::string model = "../fingers/index.toml";
    scene.replace(scene.find(model), model.size(), (directory_ / "sized.toml").string());
    const std::filesystem::path file = scenes_.scene("plane").parent_path() / "sized.toml";
    std::ofstream(file) << scene;
    return file;
  }

  const ScenesWithoutForceLimit scenes_;
  const TemporaryDirectory directory_;
  const std::filesystem::path person_ = directory_ / "anna.toml";
};

TEST_F(PersonRun, HasTheBitsOfASceneWithTheirSizeAndRegisteredPoses) {
  run(options("run.db"));
  // The poses that were taken are those of the finger.
  CsvTracker body(read_pose_csv(directory_ / "body.csv"));
  const Pose X_BodyFt = *load_person(person_).find("index")->X_BodyFt;
  RecordingReader reader(directory_ / "run.db");
  StepRecord step;
  double area = 0.0;
  while (reader.next(step)) {
    const Pose expected = body.sample(step.time).X_WFt * X_BodyFt;
    const Pose taken = step.tracked.X_WFt.pose();
    ASSERT_LT((taken.translation - expected.translation).norm(), 1e-12) << step.step;
    ASSERT_LT((taken.rotation - expected.rotation).norm(), 1e-12) << step.step;
    area = std::max(area, step.contact_area);
  }
  EXPECT_GT(area, 1.0 * mm2);
  // And from there on everything is as in a scene that has their size, to the bit.
  EXPECT_TRUE(replay({.recording = directory_ / "run.db", .scene = sized_scene()}).agree);
  EXPECT_FALSE(replay({.recording = directory_ / "run.db", .scene = scenes_.scene("plane")}).agree);
}

TEST_F(PersonRun, ReplaysWithoutThePersonsFile) {
  run(options("run.db"));
  std::filesystem::remove(person_);
  EXPECT_TRUE(replay({.recording = directory_ / "run.db", .scene = {}}).agree);
}

TEST_F(PersonRun, WaypointsAreOfTheFingerItself) {
  RunOptions scripted = options("script.db");
  scripted.trackers.clear();
  scripted.duration = 0.05;
  run(scripted);
  RecordingReader reader(directory_ / "script.db");
  StepRecord step;
  ASSERT_TRUE(reader.next(step));
  EXPECT_NEAR(step.tracked.X_WFt.translation.z(), 20.5 * mm, 1e-12);
}

TEST_F(PersonRun, NamesOfNoFingerAreRefused) {
  std::ofstream(person_) << "[indx.size]\nlength_mm = 23\n";
  try {
    (void)load_setup(options("run.db"));
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("anna.toml:1: indx"));
    EXPECT_THAT(error.what(), HasSubstr("index"));
  }
}

TEST_F(PersonRun, AFileThatIsNotThereYetIsForThoseWhoWillWriteIt) {
  std::filesystem::remove(person_);
  RunOptions none = options("run.db");
  EXPECT_THROW((void)load_setup(none), InputError);
  none.person_may_be_new = true;
  EXPECT_FALSE(load_setup(none)->registrations.at(0));
}

}  // namespace
}  // namespace softfinger
