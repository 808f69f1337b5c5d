#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "../support/folders.hpp"
#include "softfinger/actuation/device_state.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/record_fields.hpp"
#include "softfinger/viewer/events_message.hpp"
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
  EXPECT_EQ(parse_page_request(R"({"request":"stop"})", kScenes)->kind, LiveRequest::Kind::kStop);
  const auto release =
      parse_page_request(R"({"request":"release","generation":3,"stops":7})", kScenes);
  ASSERT_TRUE(release);
  EXPECT_EQ(release->kind, LiveRequest::Kind::kRelease);
  EXPECT_EQ(release->generation, 3U);
  EXPECT_EQ(release->stops, 7U);
  const auto scene = parse_page_request(R"({"scene":"edge","request":"scene"})", kScenes);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->kind, LiveRequest::Kind::kScene);
  EXPECT_EQ(scene->scene, "edge");
}

TEST(PageRequest, ReadsAPose) {
  const auto request = parse_page_request(
      R"({"request":"pose","finger":1,"position_mm":[1,-2.5,30],"quaternion":[0,0,0,1.001]})",
      kScenes);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, LiveRequest::Kind::kPose);
  EXPECT_EQ(request->finger, 1u);
  EXPECT_LT((request->X_W.translation - Vector3(1 * mm, -2.5 * mm, 30 * mm)).norm(), 1e-15);
  const Matrix3 half_turn = Vector3(-1.0, -1.0, 1.0).asDiagonal();
  EXPECT_LT((request->X_W.rotation - half_turn).norm(), 1e-12);
}

TEST(PageRequest, RefusesPosesThatAreNone) {
  const auto refused = [](const std::string& finger, const std::string& position,
                          const std::string& quaternion, const std::string& more = "") {
    return !parse_page_request(R"({"request":"pose","finger":)" + finger + R"(,"position_mm":)" +
                                   position + R"(,"quaternion":)" + quaternion + more + "}",
                               kScenes);
  };
  const std::string somewhere = "[0,0,0]";
  const std::string upright = "[1,0,0,0]";
  ASSERT_FALSE(refused("0", somewhere, upright));
  for (const char* finger : {"-1", "64", "0.5", "\"index\"", "null", "18446744073709551616"}) {
    EXPECT_TRUE(refused(finger, somewhere, upright)) << finger;
  }
  for (const char* position : {"[0,0]", "[0,0,0,0]", "[0,0,\"1\"]", "[0,0,1e999]", "[0,0,1001]",
                               "[0,-1e300,0]", "{}", "null", "7"}) {
    EXPECT_TRUE(refused("0", position, upright)) << position;
  }
  for (const char* quaternion : {"[1,0,0]", "[0,0,0,0]", "[1.02,0,0,0]", "[1e308,1e308,0,0]",
                                 "[1,0,0,null]", "[[1],0,0,0]"}) {
    EXPECT_TRUE(refused("0", somewhere, quaternion)) << quaternion;
  }
  EXPECT_TRUE(refused("0", somewhere, upright, R"(,"more":1)"));
}

TEST(PageRequest, ReadsWhereAnObjectIsHeld) {
  const auto request = parse_page_request(
      R"({"request":"hold","object":"cup","position_mm":[1,-2.5,30],"quaternion":[0,0,0,1]})",
      kScenes);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, LiveRequest::Kind::kHold);
  EXPECT_EQ(request->object, "cup");
  EXPECT_LT((request->X_W.translation - Vector3(1 * mm, -2.5 * mm, 30 * mm)).norm(), 1e-15);
  const auto let_go = parse_page_request(R"({"request":"let_go","object":"cup"})", kScenes);
  ASSERT_TRUE(let_go);
  EXPECT_EQ(let_go->kind, LiveRequest::Kind::kLetGo);
  EXPECT_EQ(let_go->object, "cup");
}

TEST(PageRequest, RefusesHoldsThatAreNone) {
  const std::string pose = R"(,"position_mm":[0,0,0],"quaternion":[1,0,0,0])";
  const auto refused = [](const std::string& rest) {
    return !parse_page_request(R"({"request":)" + rest + "}", kScenes);
  };
  ASSERT_FALSE(refused(R"("hold","object":"cup")" + pose));
  ASSERT_FALSE(refused(R"("let_go","object":"cup")"));
  for (const std::string& object : {std::string(R"("")"), std::string("4"), std::string("null"),
                                    '"' + std::string(257, 'x') + '"'}) {
    EXPECT_TRUE(refused(R"("hold","object":)" + object + pose)) << object;
    EXPECT_TRUE(refused(R"("let_go","object":)" + object)) << object;
  }
  EXPECT_TRUE(refused(R"("hold","object":"cup")"));
  EXPECT_TRUE(refused(R"("hold")" + pose));
  EXPECT_TRUE(refused(R"("hold","finger":0)" + pose));
  EXPECT_TRUE(refused(R"("let_go","object":"cup")" + pose));
  EXPECT_TRUE(refused(R"("hold","object":"cup","position_mm":[0,0,1001],"quaternion":[1,0,0,0])"));
}

TEST(PageRequest, ReadsAnObjective) {
  const auto request = parse_page_request(
      R"({"request":"objective","finger":1,"objective":"surface_and_force"})", kScenes);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, LiveRequest::Kind::kObjective);
  EXPECT_EQ(request->finger, 1U);
  EXPECT_EQ(request->objective, "surface_and_force");
  for (const std::string& rest :
       {std::string(R"("finger":1)"), std::string(R"("objective":"plane")"),
        std::string(R"("finger":64,"objective":"plane")"),
        std::string(R"("finger":-1,"objective":"plane")"),
        std::string(R"("finger":1,"objective":4)"), std::string(R"("finger":1,"objective":"")"),
        std::string(R"("finger":1,"objective":"plane","more":1)"),
        R"("finger":1,"objective":")" + std::string(65, 'x') + '"'}) {
    EXPECT_FALSE(parse_page_request(R"({"request":"objective",)" + rest + "}", kScenes)) << rest;
  }
}

TEST(PageRequest, ReadsARegistration) {
  const auto plain = parse_page_request(R"({"request":"register","finger":2})", kScenes);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->kind, LiveRequest::Kind::kRegister);
  EXPECT_EQ(plain->finger, 2U);
  EXPECT_FALSE(plain->measured.length || plain->measured.breadth || plain->measured.depth ||
               plain->table_height);
  const auto full = parse_page_request(
      R"({"request":"register","finger":0,"length_mm":25,"breadth_mm":16.5,"table_mm":-40})",
      kScenes);
  ASSERT_TRUE(full);
  EXPECT_DOUBLE_EQ(full->measured.length.value(), 25 * mm);
  EXPECT_DOUBLE_EQ(full->measured.breadth.value(), 16.5 * mm);
  EXPECT_FALSE(full->measured.depth);
  EXPECT_DOUBLE_EQ(full->table_height.value(), -40 * mm);
  EXPECT_EQ(parse_page_request(R"({"request":"cancel_registration"})", kScenes)->kind,
            LiveRequest::Kind::kCancelRegistration);
}

TEST(PageRequest, RefusesRegistrationsThatAreNone) {
  for (const char* more :
       {"", R"(,"finger":-1)", R"(,"finger":64)", R"(,"finger":0,"breadth_mm":0)",
        R"(,"finger":0,"breadth_mm":501)", R"(,"finger":0,"breadth_mm":"16")",
        R"(,"finger":0,"breadth_mm":null)", R"(,"finger":0,"table_mm":5001)",
        R"(,"finger":0,"table_mm":1e999)", R"(,"finger":0,"person":"/etc/passwd")"}) {
    EXPECT_FALSE(parse_page_request(R"({"request":"register")" + std::string(more) + "}", kScenes))
        << more;
  }
  EXPECT_FALSE(parse_page_request(R"({"request":"cancel_registration","finger":0})", kScenes));
}

TEST(PageRequest, ReadsAFit) {
  const auto plain = parse_page_request(R"({"request":"fit","finger":2})", kScenes);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->kind, LiveRequest::Kind::kFit);
  EXPECT_EQ(plain->finger, 2U);
  EXPECT_FALSE(plain->again);
  EXPECT_TRUE(
      parse_page_request(R"({"request":"fit","finger":0,"again":true})", kScenes).value().again);
  EXPECT_EQ(parse_page_request(R"({"request":"cancel_fit"})", kScenes)->kind,
            LiveRequest::Kind::kCancelFit);
  EXPECT_EQ(parse_page_request(R"({"request":"felt"})", kScenes)->kind, LiveRequest::Kind::kFelt);
  EXPECT_FALSE(parse_page_request(R"({"request":"felt","finger":0})", kScenes));
  for (const char* more :
       {"", R"(,"again":true)", R"(,"finger":64)", R"(,"finger":0,"again":1)",
        R"(,"finger":0,"more":true)", R"(,"finger":0,"again":false,"person":"/etc/passwd")"}) {
    EXPECT_FALSE(parse_page_request(R"({"request":"fit")" + std::string(more) + "}", kScenes))
        << more;
  }
  EXPECT_FALSE(parse_page_request(R"({"request":"cancel_fit","finger":0})", kScenes));
}

TEST(PageRequest, RefusesEverythingElse) {
  for (const char* message :
       {"", "pause", "{}", "[]", "null", R"("pause")", R"({"request":"fly"})", R"({"request":1})",
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
  EXPECT_EQ(json["protocol_version"], kProtocolVersion);
  EXPECT_EQ(json["scene"], "sphere");
  EXPECT_EQ(json["scenes"].size(), 7U);
  EXPECT_EQ(json["notices"].size(), 0U);
  EXPECT_EQ(json["duration_s"], 12.0);
  EXPECT_EQ(json["objects"][0]["shape"]["kind"], "sphere");
  EXPECT_NEAR(json["objects"][0]["shape"]["radius_mm"].get<double>(), 20.0, 1e-9);
  const auto& finger = json["fingers"][0];
  const auto& model = feed.description()->fingers[0];
  EXPECT_EQ(finger["skin_positions_mm"].size(), 3 * model.skin_rest_positions_F.size());
  EXPECT_EQ(finger["skin_triangles"].size(), 3 * model.skin_triangles.size());
  EXPECT_NEAR(finger["skin_positions_mm"][1].get<double>(), model.skin_rest_positions_F[0].y() / mm,
              1e-3);
  EXPECT_EQ(finger["device_kind"], "platform_3rrs");
  EXPECT_EQ(finger["device_kind_words"], "3-RRS thimble");
  EXPECT_EQ(finger["configuration_names"][0], "pitch_deg");
  EXPECT_NEAR(finger["disk_radius_mm"].get<double>(), 8.0, 1e-9);
}

TEST(SceneMessage, TellsWhatIsWrongWithADevice) {
  SyntheticFeed feed;
  feed.request({.kind = LiveRequest::Kind::kScene, .scene = "hand"});
  const auto json = nlohmann::json::parse(scene_message(*feed.description()));
  EXPECT_EQ(json["fingers"].size(), 5U);
  ASSERT_EQ(json["notices"].size(), 2U);
  EXPECT_EQ(json["notices"][1]["finger"], 4);
  EXPECT_EQ(json["notices"][1]["kind"], "approach");
  EXPECT_EQ(json["notices"][1]["text"], feed.description()->notices[1].text);
}

TEST(SceneMessage, NamesWhatLeadsADevice) {
  SyntheticFeed feed;
  const auto json = nlohmann::json::parse(scene_message(*feed.description()));
  const auto& finger = json["fingers"][0];
  ASSERT_EQ(finger["objectives"], nlohmann::json::parse("[0,1]"));
  EXPECT_EQ(json["objectives"][1]["name"], "surface_and_force");
  EXPECT_EQ(json["objectives"][1]["words"], "contact surface and force");
}

// The page has no names of its own.
TEST(SceneMessage, NamesStatesAndStages) {
  const auto json = nlohmann::json::parse(scene_message({}));
  ASSERT_EQ(json["device_states"].size(), kDeviceStates.size());
  EXPECT_EQ(json["device_states"].front()["name"], "disconnected");
  EXPECT_EQ(json["device_states"].front()["tone"], "fault");
  EXPECT_EQ(json["device_states"].back()["name"], "ready");
  ASSERT_EQ(json["latency_stages"].size(), kLatencyStages);
  for (std::size_t i = 0; i < kLatencyStages; ++i) {
    EXPECT_EQ(json["latency_stages"][i]["name"], kLatencyStageNames[i].name);
    EXPECT_EQ(json["latency_stages"][i]["words"], kLatencyStageNames[i].words);
  }
}

TEST(SceneMessage, NamesEachShape) {
  SceneDescription scene;
  scene.objects = {{"a", HalfSpace{}},
                   {"b", RoundedBox{Vector3(1, 2, 3) * mm, 0.5 * mm}},
                   {"c", RoundedCylinder{4 * mm, 10 * mm, 0.0}},
                   {"d", TaperedCapsule{9 * mm, 8 * mm, 20 * mm}, {}, {}, "right"}};
  scene.objects[2].joint = "hinge";
  const auto objects = nlohmann::json::parse(scene_message(scene))["objects"];
  EXPECT_TRUE(objects[0]["joint"].is_null());
  EXPECT_EQ(objects[2]["joint"], "hinge");
  EXPECT_EQ(objects[0]["shape"]["kind"], "plane");
  EXPECT_NEAR(objects[1]["shape"]["size_mm"][2].get<double>(), 6.0, 1e-9);
  EXPECT_NEAR(objects[2]["shape"]["length_mm"].get<double>(), 20.0, 1e-9);
  EXPECT_TRUE(objects[2]["hand"].is_null());
  EXPECT_EQ(objects[3]["shape"]["kind"], "mesh");
  EXPECT_EQ(objects[3]["hand"], "right");
}

// What is soft is told as it is at rest.
TEST(SceneMessage, TellsTheSurfaceOfWhatIsSoft) {
  SceneDescription scene;
  scene.objects = {{"sponge", {}, {Vector3(0, 0, 1) * mm, Vector3::Zero()}, {{0, 1, 0}}}};
  const auto shape = nlohmann::json::parse(scene_message(scene))["objects"][0]["shape"];
  EXPECT_EQ(shape,
            nlohmann::json::parse(R"({"kind":"soft","positions_mm":[0.0,0.0,1.0,0.0,0.0,0.0],)"
                                  R"("triangles":[0,1,0]})"));
}

// A field of pins has hundreds of pieces of one shape.
TEST(SceneMessage, TellsAlikePiecesOnce) {
  SceneDescription scene;
  SceneDescription::Finger& finger = scene.fingers.emplace_back();
  finger.pieces.assign(36, RoundedCylinder{0.5 * mm, 2 * mm, 0.1 * mm});
  finger.pieces.emplace_back(Ball{3 * mm});
  finger.pieces.emplace_back(RoundedCylinder{0.5 * mm, 2 * mm, 0.1 * mm});
  finger.cap_radius = 7 * mm;
  const auto json = nlohmann::json::parse(scene_message(scene))["fingers"][0];
  ASSERT_EQ(json["pieces"].size(), 3U);
  EXPECT_EQ(json["pieces"][0]["count"], 36);
  EXPECT_EQ(json["pieces"][0]["shape"]["kind"], "cylinder");
  EXPECT_NEAR(json["pieces"][0]["shape"]["length_mm"].get<double>(), 4.0, 1e-9);
  EXPECT_EQ(json["pieces"][1]["count"], 1);
  EXPECT_NEAR(json["pieces"][1]["shape"]["radius_mm"].get<double>(), 3.0, 1e-9);
  EXPECT_EQ(json["pieces"][2]["count"], 1);
  EXPECT_NEAR(json["cap_radius_mm"].get<double>(), 7.0, 1e-9);
}

TEST(SceneMessage, TellsTheWorkspace) {
  SceneDescription scene;
  WorkspaceOutline& workspace = scene.fingers.emplace_back().workspace;
  workspace.reaches = {{"x_mm", -2 * mm, 3 * mm, mm}, {"yaw_deg", -0.1, 0.1, deg}};
  workspace.tilt_layers = {{1 * mm, {10 * deg, 20 * deg}}};
  workspace.pitch_axis = 4;
  const auto json = nlohmann::json::parse(scene_message(scene))["fingers"][0]["workspace"];
  EXPECT_EQ(json["reaches"][0]["name"], "x_mm");
  EXPECT_NEAR(json["reaches"][0]["min"].get<double>(), -2.0, 1e-9);
  EXPECT_NEAR(json["reaches"][1]["max"].get<double>(), 0.1 / deg, 1e-9);
  EXPECT_NEAR(json["tilt_layers"][0]["travel_mm"].get<double>(), 1.0, 1e-3);
  EXPECT_NEAR(json["tilt_layers"][0]["tilts_deg"][1].get<double>(), 20.0, 1e-3);
  EXPECT_EQ(json["pitch_axis"], 4);
  EXPECT_EQ(json["roll_axis"], -1);
}

TEST(SceneMessage, BrokenTextDoesNotEndIt) {
  SceneDescription scene;
  scene.scene_name = "\xff\xfe";
  EXPECT_TRUE(nlohmann::json::accept(scene_message(scene)));
}

TEST(EventsMessage, HasWhatIsKnownOfEach) {
  const std::vector<LiveEvent> events{
      {1.25, "impact", "cup", "thumb", 0.5},
      {2.0, "click", "but\xffton", "", std::numeric_limits<double>::quiet_NaN()}};
  const auto json = nlohmann::json::parse(events_message(7, events));
  EXPECT_EQ(json["type"], "events");
  EXPECT_EQ(json["generation"], 7);
  EXPECT_EQ(json["events"][0],
            nlohmann::json::parse(R"({"time_s":1.25,"kind":"impact","object":"cup",)"
                                  R"("other":"thumb","impulse_N_s":0.5})"));
  EXPECT_TRUE(json["events"][1]["other"].is_null());
  EXPECT_TRUE(json["events"][1]["impulse_N_s"].is_null());
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
  snapshot.stops = 9;
  snapshot.stopped.asked = true;
  snapshot.time = 1.234;
  snapshot.wall_time = 4294968.296;  // a second after 2^32 ms
  snapshot.step_cpu_time = 0.2 * ms;
  snapshot.deadline_misses = 3;
  snapshot.X_WO.resize(1);
  snapshot.X_WO[0].translation = Vector3(0, 0, 5 * mm);
  snapshot.fingers.resize(1);
  Snapshot::Finger& finger = snapshot.fingers[0];
  finger.normal_force = 0.75;
  finger.normal_force_sum = 0.8125;
  finger.contact_area = 42 * mm2;
  finger.deviation = 1.5 * mm2;
  finger.skin.positions_F.assign(5, Eigen::Vector3f(0.001F, 0.002F, 0.003F));
  finger.skin.pressures.assign(5, 2000.0F);
  finger.skin.in_contact = {0, 1, 0, 1, 1};
  finger.configuration = Eigen::Vector2d(10 * deg, 1.5 * mm);
  finger.joints = Eigen::Vector3d(1, 2, 3) * deg;
  finger.linkage_F.assign(9, Eigen::Vector3f(0.01F, 0.0F, 0.0F));
  finger.pieces.resize(2);
  finger.pieces[1].X_FS.translation = Vector3(0, 0, -9 * mm);
  finger.pieces[1].ball_radius = 12 * mm;
  finger.device_state = "rendering";
  finger.force_limited = true;
  finger.objective = 3;
  finger.twin.pressed = true;
  finger.twin.skin = finger.skin;
  finger.twin.skin.in_contact = {1, 0, 0, 0, 0};
  finger.twin.measures.iou = 0.5;
  finger.twin.measures.centroid_shift = 1.5 * mm;
  finger.twin.normal_force = 0.625;
  finger.twin.normal_force_sum = 0.6875;
  finger.twin.cpu_time = 2 * ms;
  finger.twin.tangential_force = 0.375;
  finger.twin.measures.tangential_force_error = 0.5;
  finger.twin.measures.slip_ratio_error = 0.125;
  finger.slip_ratio = 0.25;
  finger.stuck_fraction = 0.875;
  finger.tick = 17;
  finger.stages[LatencyStage::kSend] = 3 * ms;
  finger.device_said = 12 * ms;
  finger.actual = Eigen::Vector2d(9 * deg, 1.25 * mm);
  snapshot.soft_objects = {{4, {Eigen::Vector3f::Zero(), {-0.007F, 0.0F, 0.001F}}}};

  std::vector<std::byte> message;
  write_snapshot_message(snapshot, scene, message);
  const std::size_t pose = 28;
  const std::size_t samples = 56 + pose + 3 * pose + 28 + 32 + 32 + 16;
  const std::size_t pieces = samples + 5 * 16 + 8 + 4 * (2 + 2 + 3 + 27);
  const std::size_t twin = pieces + 2 * 32;
  const std::size_t soft = twin + 48 + 5 * 16 + 8;
  ASSERT_EQ(message.size(), soft + 8 + 2 * 12);
  EXPECT_EQ(read_at<std::uint32_t>(message, 0), kSnapshotMagic);
  EXPECT_EQ(std::memcmp(message.data(), "SFSA", 4), 0);
  EXPECT_EQ(read_at<std::uint32_t>(message, 4), 7U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 8), 1234U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 12), 1U + 4U);
  EXPECT_EQ(read_at<double>(message, 16), 1.234);
  EXPECT_FLOAT_EQ(read_at<float>(message, 24), 0.2F);
  EXPECT_EQ(read_at<std::uint32_t>(message, 32), 3U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 36), 1U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 40), 1U);
  EXPECT_NEAR(read_at<std::uint32_t>(message, 44), 1000U, 1U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 48), 9U);
  EXPECT_EQ(read_at<std::uint32_t>(message, 52), 1U);
  EXPECT_FLOAT_EQ(read_at<float>(message, 56 + 8), 5.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, 56 + 24), 1.0F);  // quaternion w
  const std::size_t forces = 56 + 4 * pose;
  EXPECT_FLOAT_EQ(read_at<float>(message, forces), 42.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 4), 0.75F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 12), 0.25F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 16), 0.875F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 20), 0.8125F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 24), 1.5F);
  EXPECT_EQ(read_at<std::uint32_t>(message, forces + 28), 17U);
  EXPECT_TRUE(std::isnan(read_at<float>(message, forces + 32))) << "a stage that is not known";
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 48), 3.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, forces + 56), 12.0F);
  const std::size_t counts = forces + 60;
  EXPECT_EQ(read_at<std::uint32_t>(message, counts), 5U);
  EXPECT_EQ(read_at<std::uint32_t>(message, counts + 12), 9U);
  EXPECT_EQ(read_at<std::uint32_t>(message, counts + 16), 2U);
  EXPECT_EQ(read_at<std::uint32_t>(message, counts + 20), 5U);
  EXPECT_EQ(read_at<std::uint32_t>(message, counts + 24), 2U);
  EXPECT_EQ(read_at<std::uint32_t>(message, counts + 28), 1U + 256U * 3U);
  EXPECT_EQ(std::memcmp(message.data() + counts + 32, "rendering\0\0\0\0\0\0\0", 16), 0);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 8), 3.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 60), 2.0F);  // kPa
  EXPECT_EQ(read_at<std::uint8_t>(message, samples + 81), 1U);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 88), 10.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 92), 1.5F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 96), 9.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 100), 1.25F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 112), 3.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, samples + 116), 10.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, pieces + 28), 0.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, pieces + 32 + 8), -9.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, pieces + 32 + 24), 1.0F);  // quaternion w
  EXPECT_FLOAT_EQ(read_at<float>(message, pieces + 32 + 28), 12.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin), 0.5F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 4), 1.5F);
  EXPECT_TRUE(std::isnan(read_at<float>(message, twin + 8))) << "an undefined measure";
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 20), 0.625F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 28), 2.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 32), 0.6875F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 36), 0.375F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 40), 0.5F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 44), 0.125F);
  EXPECT_FLOAT_EQ(read_at<float>(message, twin + 48 + 8), 3.0F);
  EXPECT_EQ(read_at<std::uint8_t>(message, twin + 48 + 80), 1U);
  EXPECT_EQ(read_at<std::uint32_t>(message, soft), 4U);
  EXPECT_EQ(read_at<std::uint32_t>(message, soft + 4), 2U);
  EXPECT_FLOAT_EQ(read_at<float>(message, soft + 8 + 12), -7.0F);
  EXPECT_FLOAT_EQ(read_at<float>(message, soft + 8 + 20), 1.0F);
}

TEST(SnapshotMessage, ClientsKnowTheSumsByTheirNamesInOrder) {
  std::ifstream file(source_folder() + "/clients/javascript/src/wire.js");
  std::string names;
  std::getline(file, names, '\0');
  names = names.substr(names.find("kContactSums = ["));
  names = names.substr(0, names.find(']'));
  std::vector<std::string> known;
  for (std::size_t at = names.find('"'); at != std::string::npos; at = names.find('"', at + 1)) {
    const std::size_t begin = at + 1;
    at = names.find('"', begin);
    known.push_back(names.substr(begin, at - begin));
  }
  std::vector<std::string> sent;
  for_each_live_field({}, [&](std::string_view name, double) { sent.emplace_back(name); });
  EXPECT_EQ(known, sent);
}

TEST(SnapshotMessage, ATwinNotPressedIsLeftOut) {
  SceneDescription scene;
  Snapshot snapshot;
  snapshot.fingers.resize(1);
  snapshot.fingers[0].twin.skin.positions_F.resize(3, Eigen::Vector3f::Zero());
  snapshot.fingers[0].twin.skin.pressures.resize(3);
  snapshot.fingers[0].twin.skin.in_contact.resize(3);
  std::vector<std::byte> message;
  write_snapshot_message(snapshot, scene, message);
  EXPECT_EQ(read_at<std::uint32_t>(message, 56 + 3 * 28 + 28 + 32 + 20), 0U);
  EXPECT_EQ(message.size(), 56U + 3 * 28 + 28 + 32 + 32 + 16);
}

TEST(SnapshotMessage, UnequalSamplesAreCutToTheShortest) {
  SceneDescription scene;
  Snapshot snapshot;
  snapshot.fingers.resize(1);
  snapshot.fingers[0].skin.positions_F.resize(4, Eigen::Vector3f::Zero());
  snapshot.fingers[0].skin.pressures.resize(3);
  snapshot.fingers[0].skin.in_contact.resize(2);
  std::vector<std::byte> message;
  write_snapshot_message(snapshot, scene, message);
  EXPECT_EQ(read_at<std::uint32_t>(message, 56 + 3 * 28 + 28 + 32), 2U);
}

}  // namespace
}  // namespace softfinger
