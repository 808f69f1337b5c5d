#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "softfinger/base/units.hpp"
#include "softfinger/viewer/page_request.hpp"
#include "softfinger/viewer/scene_message.hpp"
#include "softfinger/viewer/snapshot_message.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

const std::vector<std::string> kScenes = {"plane", "edge"};

TEST(PageRequest, ReadsEachKind) {
  EXPECT_EQ(parse_page_request(R"({"request":"pause"})", kScenes)->kind, LiveRequest::Kind::kPause);
  EXPECT_EQ(parse_page_request(R"({"request":"resume"})", kScenes)->kind,
            LiveRequest::Kind::kResume);
  EXPECT_EQ(parse_page_request(R"({"request":"restart"})", kScenes)->kind,
            LiveRequest::Kind::kRestart);
  const auto scene = parse_page_request(R"({"scene":"edge","request":"scene"})", kScenes);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->kind, LiveRequest::Kind::kScene);
  EXPECT_EQ(scene->scene, "edge");
}

TEST(PageRequest, RefusesEverythingElse) {
  for (const char* message :
       {"", "pause", "{}", "[]", "null", R"("pause")", R"({"request":"stop"})", R"({"request":1})",
        R"({"request":"pause","more":1})", R"({"request":"scene"})",
        R"({"request":"scene","scene":"../edge"})", R"({"request":"scene","scene":2})",
        R"({"request":"scene","scene":"edge","more":1})",
        R"({"request":"pause"} )"
        "x",
        R"({"request":"pause")", "\xff\xfe", "[[[[[[[[[[[[[[[["}) {
    EXPECT_FALSE(parse_page_request(message, kScenes)) << message;
  }
}

TEST(SceneMessage, HasWhatThePageDraws) {
  SyntheticFeed feed;
  const auto json = nlohmann::json::parse(scene_message(*feed.description()));
  EXPECT_EQ(json["type"], "scene");
  EXPECT_EQ(json["scene"], "sphere");
  EXPECT_EQ(json["scenes"].size(), 3U);
  EXPECT_EQ(json["duration_s"], 12.0);
  EXPECT_EQ(json["objects"][0]["shape"]["kind"], "sphere");
  EXPECT_NEAR(json["objects"][0]["shape"]["radius_mm"].get<double>(), 20.0, 1e-9);
  const auto& finger = json["fingers"][0];
  const auto& model = feed.description()->fingers[0];
  EXPECT_EQ(finger["skin_positions_mm"].size(), 3 * model.skin_rest_positions_F.size());
  EXPECT_EQ(finger["skin_triangles"].size(), 3 * model.skin_triangles.size());
  EXPECT_NEAR(finger["skin_positions_mm"][1].get<double>(), model.skin_rest_positions_F[0].y() / mm,
              1e-3);
  EXPECT_EQ(finger["configuration_names"][0], "pitch_deg");
  EXPECT_NEAR(finger["disk_radius_mm"].get<double>(), 8.0, 1e-9);
}

TEST(SceneMessage, NamesEachShape) {
  SceneDescription scene;
  scene.objects = {{"a", HalfSpace{}},
                   {"b", RoundedBox{Vector3(1, 2, 3) * mm, 0.5 * mm}},
                   {"c", RoundedCylinder{4 * mm, 10 * mm, 0.0}}};
  const auto objects = nlohmann::json::parse(scene_message(scene))["objects"];
  EXPECT_EQ(objects[0]["shape"]["kind"], "plane");
  EXPECT_NEAR(objects[1]["shape"]["size_mm"][2].get<double>(), 6.0, 1e-9);
  EXPECT_NEAR(objects[2]["shape"]["length_mm"].get<double>(), 20.0, 1e-9);
}

TEST(SceneMessage, BrokenTextDoesNotEndIt) {
  SceneDescription scene;
  scene.scene_name = "\xff\xfe";
  EXPECT_TRUE(nlohmann::json::accept(scene_message(scene)));
}

template <typename T>
T read_at(const std::vector<std::byte>& message, std::size_t offset) {
  T value;
  std::memcpy(&value, message.data() + offset, sizeof value);
  return value;
}

TEST(SnapshotMessage, FollowsItsLayout) {
  SceneDescription scene;
  scene.fingers.resize(1);
  scene.fingers[0].configuration_names = {"pitch_deg", "travel_mm"};
  Snapshot snapshot;
  snapshot.generation = 7;
  snapshot.step = 1234;
  snapshot.paused = true;
  snapshot.time = 1.234;
  snapshot.step_cpu_time = 0.2 * ms;
  snapshot.deadline_misses = 3;
  snapshot.X_WO.resize(1);
  snapshot.X_WO[0].translation = Vector3(0, 0, 5 * mm);
  snapshot.fingers.resize(1);
  Snapshot::Finger& finger = snapshot.fingers[0];
  finger.normal_force = 0.75;
  finger.contact_area = 42 * mm2;
  finger.sample_positions_F.assign(5, Eigen::Vector3f(0.001F, 0.002F, 0.003F));
  finger.sample_pressures.assign(5, 2000.0F);
  finger.in_contact = {0, 1, 0, 1, 1};
  finger.configuration = Eigen::Vector2d(10 * deg, 1.5 * mm);
  finger.joints = Eigen::Vector3d(1, 2, 3) * deg;
  finger.linkage_F.assign(9, Eigen::Vector3f(0.01F, 0.0F, 0.0F));
  finger.device_state = "rendering";
  finger.slip_ratio = 0.25;
  finger.stuck_fraction = 0.875;

  std::vector<std::byte> message;
  write_snapshot_message(snapshot, scene, message);
  const std::size_t pose = 28;
  const std::size_t samples = 48 + pose + 3 * pose + 24 + 16 + 16;
  ASSERT_EQ(message.size(), samples + 5 * 16 + 8 + 4 * (2 + 3 + 27));
  EXPECT_EQ(read_at<std::uint32_t>(message, 0), kSnapshotMagic);
  EXPECT_EQ(std::memcmp(message.data(), "SFS2", 4), 0);
  EXPECT_EQ(read_at<std::uint32_t>(message, 4), 7U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 8), 1234U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 12), 1U);
  EXPECT_EQ(read_at<double>(message, 16), 1.234);
  EXPECT_FLOAT_EQ(read_at<float>(message, 24), 0.2F);
  EXPECT_EQ(read_at<std::uint32_t>(message, 32), 3U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 36), 1U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 40), 1U);
  EXPECT_FLOAT_EQ(read_at<float>(message, 48 + 8), 5.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, 48 + 24), 1.0F);  // quaternion w
  const std::size_t forces = 48 + 4 * pose;
  EXPECT_FLOAT_EQ(read_at<float>(message, forces), 0.75F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 8), 42.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 16), 0.25F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 20), 0.875F);
  EXPECT_EQ(read_at<std::uint32_t>(message, forces + 24), 5U);
  EXPECT_EQ(read_at<std::uint32_t>(message, forces + 36), 9U);
  EXPECT_EQ(std::memcmp(message.data() + forces + 40, "rendering\0\0\0\0\0\0\0", 16), 0);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 8), 3.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 60), 2.0F);  // kPa
  EXPECT_EQ(read_at<std::uint8_t>(message, samples + 81), 1U);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 88), 10.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 92), 1.5F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 104), 3.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 108), 10.0F);
}

TEST(SnapshotMessage, UnequalSamplesAreCutToTheShortest) {
  SceneDescription scene;
  Snapshot snapshot;
  snapshot.fingers.resize(1);
  snapshot.fingers[0].sample_positions_F.resize(4, Eigen::Vector3f::Zero());
  snapshot.fingers[0].sample_pressures.resize(3);
  snapshot.fingers[0].in_contact.resize(2);
  std::vector<std::byte> message;
  write_snapshot_message(snapshot, scene, message);
  EXPECT_EQ(read_at<std::uint32_t>(message, 48 + 3 * 28 + 24), 2U);
}

}  // namespace
}  // namespace softfinger
