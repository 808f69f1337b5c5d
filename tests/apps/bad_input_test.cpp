// Bad input of every kind: exit status 2, nothing on stdout, exactly one line on stderr that says
// where it is.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

/// Runs the program; it must refuse, and its one line must contain all of `words`.
void expect_refused(const std::vector<std::string>& arguments,
                    const std::vector<std::string>& words) {
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, 2) << run.errors;
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(std::ranges::count(run.errors, '\n'), 1) << run.errors;
  EXPECT_TRUE(run.errors.ends_with('\n')) << run.errors;
  for (const std::string& word : words) EXPECT_THAT(run.errors, HasSubstr(word));
}

// --- Keys and values
// ------------------------------------------------------------------------------

/// One spoilt line of a file, and what the message must name besides file and line.
struct SpoiltLine {
  const char* name;
  const char* file;
  const char* begin;   ///< of the line that is spoilt
  const char* spoilt;  ///< what stands there instead
  std::vector<std::string> words;
};

std::vector<std::string> command_for(const std::string& file, const std::string& path) {
  if (file.starts_with("fingers")) return {"finger", "show", path};
  if (file.starts_with("devices")) return {"device", "show", path};
  return {"scene", "check", path};
}

class SpoiltLineTest : public testing::TestWithParam<SpoiltLine> {};

TEST_P(SpoiltLineTest, IsNamedWithFileLineAndKey) {
  const SpoiltLine& spoilt = GetParam();
  const Workplace place;
  const std::string file = spoilt.file;
  const int line = place.replace_line(file, spoilt.begin, spoilt.spoilt);
  std::vector<std::string> words = spoilt.words;
  words.push_back(file.substr(file.find('/') + 1) + ":" + std::to_string(line) + ":");
  expect_refused(command_for(file, place.path(file)), words);
}

const std::string kFinger = "fingers/index.toml";

INSTANTIATE_TEST_SUITE_P(
    Toml, SpoiltLineTest,
    testing::Values(
        SpoiltLine{"UnknownKeyOfScene",
                   "scenes/sphere.toml",
                   "radius_mm",
                   "radus_mm = 20.0",
                   {"radus_mm", "radius_mm"}},
        SpoiltLine{"WrongUnitOfScene",
                   "scenes/sphere.toml",
                   "radius_mm",
                   "radius_cm = 2.0",
                   {"radius_cm", "radius_mm"}},
        SpoiltLine{"WrongTypeInScene",
                   "scenes/sphere.toml",
                   "radius_mm",
                   "radius_mm = \"large\"",
                   {"radius_mm"}},
        SpoiltLine{
            "NanInScene", "scenes/sphere.toml", "radius_mm", "radius_mm = nan", {"radius_mm"}},
        SpoiltLine{"NegativeSizeInScene",
                   "scenes/sphere.toml",
                   "radius_mm",
                   "radius_mm = -20.0",
                   {"radius_mm"}},
        SpoiltLine{"UnknownShape",
                   "scenes/sphere.toml",
                   "shape",
                   "shape = \"torus\"",
                   {"shape", "torus", "sphere"}},
        SpoiltLine{"UnknownTracker",
                   "scenes/sphere.toml",
                   "tracker",
                   "tracker = \"dowsing\"",
                   {"tracker", "dowsing"}},
        SpoiltLine{"ShortPosition",
                   "scenes/sphere.toml",
                   "position_mm",
                   "position_mm = [0.0, 1.0]",
                   {"position_mm"}},
        SpoiltLine{"NotToml", "scenes/sphere.toml", "name", "name = = 1", {}},
        SpoiltLine{"UnknownKeyOfFinger",
                   "fingers/index.toml",
                   "youngs_modulus_kPa",
                   "youngs_modulus_kpa = 45.0",
                   {"youngs_modulus_kpa", "youngs_modulus_kPa"}},
        SpoiltLine{"PoissonsRatioOutOfRange",
                   "fingers/index.toml",
                   "poissons_ratio",
                   "poissons_ratio = 0.5",
                   {"poissons_ratio"}},
        SpoiltLine{"InfiniteDensity",
                   "fingers/index.toml",
                   "density_kg_per_m3",
                   "density_kg_per_m3 = inf",
                   {"density_kg_per_m3"}},
        SpoiltLine{
            "WidthThatStressesTheRest", "fingers/index.toml", "width", "width = 0.9", {"width"}},
        SpoiltLine{
            "UnitOfMesh", "fingers/index.toml", "unit", "unit = \"inch\"", {"unit", "inch", "mm"}},
        SpoiltLine{"UnknownKeyOfDevice",
                   "devices/thimble-3rrs.toml",
                   "crank_mm",
                   "cranc_mm = 12.0",
                   {"cranc_mm", "crank_mm"}},
        SpoiltLine{"NegativeSizeInDevice",
                   "devices/thimble-3rrs.toml",
                   "disk_radius_mm",
                   "disk_radius_mm = -8.0",
                   {"disk_radius_mm"}},
        SpoiltLine{"UnknownDevice",
                   "devices/thimble-3rrs.toml",
                   "kind",
                   "kind = \"platform_4rrs\"",
                   {"kind", "platform_4rrs", "platform_3rrs"}},
        SpoiltLine{"LimitsInWrongOrder",
                   "devices/thimble-3rrs.toml",
                   "joint_deg",
                   "joint_deg = [75.0, -30.0]",
                   {"joint_deg"}},
        SpoiltLine{"ServoThatWouldNotMove",
                   "devices/thimble-3rrs.toml",
                   "us_per_deg",
                   "us_per_deg = 0.0",
                   {"us_per_deg"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(BadInput, SceneWithoutAFinger) {
  const Workplace place;
  place.write("scenes/empty.toml", "[[object]]\nshape = \"sphere\"\nradius_mm = 20.0\n");
  expect_refused({"scene", "check", place.path("scenes/empty.toml")}, {"finger: a scene needs"});
  // A misspelt table may be the reason.
  place.write("scenes/empty.toml", "[[object]]\nshape = \"plane\"\n[[fingr]]\nname = \"index\"\n");
  expect_refused({"scene", "check", place.path("scenes/empty.toml")},
                 {"empty.toml:3: fingr: unknown key 'fingr'; did you mean 'finger'?"});
}

TEST(BadInput, MissingFilesAreNamed) {
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"scene", "check"}, {"finger", "show"}, {"device", "show"}}) {
    expect_refused({command[0], command[1], "/nowhere/at-all.toml"}, {"/nowhere/at-all.toml"});
  }
}

TEST(BadInput, FileNamedByTheSceneIsMissing) {
  const Workplace place;
  const int line =
      place.replace_line("scenes/sphere.toml", "model", "model = \"../fingers/thumb.toml\"");
  expect_refused({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "0.1"},
                 {"thumb.toml"});
  EXPECT_GT(line, 0);
}

// --- Meshes
// ---------------------------------------------------------------------------------------

/// Two tetrahedra of tissue on a common face; `elements` are lines "type 2 physical 1 nodes...".
std::string mesh_of(const std::vector<std::string>& elements,
                    const std::string& names = "3\n2 1 \"skin\"\n2 2 \"bone\"\n3 3 \"tissue\"") {
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n" + names +
      "\n$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 5 0 0\n3 0 5 0\n4 0 0 5\n5 0 0 -5\n"
      "6 9 9 9\n$EndNodes\n$Elements\n" +
      std::to_string(elements.size()) + "\n";
  for (std::size_t i = 0; i < elements.size(); ++i) {
    text += std::to_string(i + 1) + " " + elements[i] + "\n";
  }
  return text + "$EndElements\n";
}

const std::vector<std::string> kSoundElements{"4 2 3 1 1 2 3 4", "4 2 3 1 1 3 2 5",
                                              "2 2 1 1 1 2 5",   "2 2 1 1 2 3 5",
                                              "2 2 2 1 2 3 4",   "2 2 2 1 1 2 4"};

struct RefusedMesh {
  const char* name;
  std::string text;
  std::vector<std::string> words;
};

class RefusedMeshTest : public testing::TestWithParam<RefusedMesh> {};

TEST_P(RefusedMeshTest, SaysWhy) {
  const Workplace place;
  place.write("fingers/index.msh", GetParam().text);
  std::vector<std::string> words = GetParam().words;
  words.push_back("index.msh");
  expect_refused({"finger", "show", place.path(kFinger)}, words);
}

std::vector<std::string> without(std::size_t from) {
  return {kSoundElements.begin(), kSoundElements.begin() + static_cast<long>(from)};
}

std::vector<std::string> with(std::vector<std::string> more) {
  std::vector<std::string> all = kSoundElements;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    Msh, RefusedMeshTest,
    testing::Values(RefusedMesh{"SurfaceOnly", mesh_of({"2 2 1 1 1 2 3"}), {"tetrahedra"}},
                    RefusedMesh{"TriangleThatIsNoFace", mesh_of(with({"2 2 1 1 1 2 6"})), {"face"}},
                    RefusedMesh{"NotAManifold",
                                mesh_of({"4 2 3 1 1 2 3 4", "4 2 3 1 1 5 6 2", "2 2 1 1 1 2 3",
                                         "2 2 2 1 1 2 4"}),
                                {"manifold"}},
                    RefusedMesh{"DegenerateElement", mesh_of(with({"4 2 3 1 1 2 3 3"})), {}},
                    RefusedMesh{"NoSkin",
                                mesh_of({"4 2 3 1 1 2 3 4", "2 2 2 1 1 2 4"},
                                        "2\n2 2 \"bone\"\n3 3 \"tissue\""),
                                {"skin"}},
                    RefusedMesh{
                        "NoBone", mesh_of(without(4), "2\n2 1 \"skin\"\n3 3 \"tissue\""), {"bone"}},
                    RefusedMesh{"NewerFormat",
                                "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n",
                                {"index.msh:2:", "4.1", "2.2"}},
                    RefusedMesh{"Empty", "", {}},
                    RefusedMesh{"CutInTheMiddle", mesh_of(kSoundElements).substr(0, 150), {}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// --- Points
// ---------------------------------------------------------------------------------------

struct BadPoints {
  const char* name;
  std::string text;
  std::vector<std::string> words;
  std::vector<std::string> flags;
};

class BadPointsTest : public testing::TestWithParam<BadPoints> {};

TEST_P(BadPointsTest, AreRefused) {
  const Workplace place;
  place.write("points.json", GetParam().text);
  std::vector<std::string> arguments{"match", place.path("devices/thimble-3rrs.toml"), "--points",
                                     place.path("points.json")};
  arguments.insert(arguments.end(), GetParam().flags.begin(), GetParam().flags.end());
  std::vector<std::string> words = GetParam().words;
  words.push_back("points.json");
  expect_refused(arguments, words);
}

const std::string kTwoPoints = R"("points_mm": [[0, 0, -7], [1, 0, -7]])";

INSTANTIATE_TEST_SUITE_P(
    Json, BadPointsTest,
    testing::Values(
        BadPoints{
            "UnequalLengths", "{" + kTwoPoints + R"(, "in_contact": [true]})", {"in_contact"}, {}},
        BadPoints{"NoPoints", R"({"points_mm": [], "in_contact": []})", {"points_mm"}, {}},
        BadPoints{"NoContacts", "{" + kTwoPoints + "}", {"in_contact"}, {}},
        BadPoints{"UnknownKey",
                  "{" + kTwoPoints + R"(, "in_contact": [true, false], "in_contakt": []})",
                  {"in_contakt", "in_contact"},
                  {}},
        BadPoints{"TwoCoordinates",
                  R"({"points_mm": [[0, 0]], "in_contact": [true]})",
                  {"points_mm"},
                  {}},
        BadPoints{"WrongType", "{" + kTwoPoints + R"(, "in_contact": [1, 0]})", {"in_contact"}, {}},
        BadPoints{"NotANumber",
                  R"({"points_mm": [[0, 0, null]], "in_contact": [true]})",
                  {"points_mm"},
                  {}},
        BadPoints{"NegativeArea",
                  "{" + kTwoPoints + R"(, "in_contact": [true, false], "area_mm2": [1, -1]})",
                  {"area_mm2"},
                  {}},
        BadPoints{"SceneWithoutDistances",
                  "{" + kTwoPoints + R"(, "in_contact": [true, false]})",
                  {"distance_mm"},
                  {"--separation", "scene"}},
        BadPoints{"AreaWithoutAreas",
                  "{" + kTwoPoints + R"(, "in_contact": [true, false]})",
                  {"area_mm2"},
                  {"--weights", "area"}},
        BadPoints{"NotJson", "{\"points_mm\": [", {}, {}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// --- Recordings, ports, flags
// ---------------------------------------------------------------------

TEST(BadInput, FileThatIsNoRecording) {
  const Workplace place;
  place.write("letter.txt", "Dear reader,\n");
  for (const char* command : {"replay", "export"}) {
    std::vector<std::string> arguments{command, place.path("letter.txt")};
    if (std::string(command) == "export")
      arguments.insert(arguments.end(), {"--to", place.path("out")});
    expect_refused(arguments, {"letter.txt"});
  }
}

TEST(BadInput, DamagedRecording) {
  const Workplace place;
  const std::string file = place.path("run.sqlite");
  const ProgramRun run =
      run_program({"run", place.path("scenes/plane.toml"), "--headless", "--as-fast-as-possible",
                   "--duration-s", "0.2", "--record", file, "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  std::string bytes = place.read("run.sqlite");
  ASSERT_GT(bytes.size(), 10000U);
  // Every page but the first.
  for (std::size_t i = 4096; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 37);
  place.write("run.sqlite", bytes);
  expect_refused({"replay", file}, {"run.sqlite"});
  expect_refused({"export", file, "--to", place.path("out")}, {"run.sqlite"});
}

TEST(BadInput, RecordingIsNeverOverwritten) {
  const Workplace place;
  place.write("keep.sqlite", "precious");
  expect_refused({"run", place.path("scenes/plane.toml"), "--headless", "--duration-s", "0.1",
                  "--record", place.path("keep.sqlite")},
                 {"keep.sqlite"});
  EXPECT_EQ(place.read("keep.sqlite"), "precious");
}

TEST(BadInput, NumberOfThreads) {
  const Workplace place;
  for (const char* threads : {"0", "-1", "65"}) {
    expect_refused({"run", place.path("scenes/plane.toml"), "--headless", "--duration-s", "0.1",
                    "--threads", threads},
                   {"--threads", threads, "1 to 64"});
  }
}

TEST(BadInput, PortInUse) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  ASSERT_EQ(bind(listener, any, size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, any, &size), 0);
  const std::string port = std::to_string(ntohs(address.sin_port));
  const Workplace place;
  expect_refused({"run", place.path("scenes/plane.toml"), "--port", port}, {"--port", port});
  close(listener);
}

TEST(BadInput, SerialPortAbsentAtTheStart) {
  const Workplace place;
  place.replace_line("devices/thimble-3rrs.toml", "port", "port = \"/dev/ttyNOTTHERE\"");
  expect_refused({"run", place.path("scenes/plane.toml"), "--headless", "--duration-s", "0.1"},
                 {"thimble-3rrs.toml", "port", "/dev/ttyNOTTHERE"});
}

TEST(BadInput, SerialPortAbsentIsNoErrorForThoseWhoWait) {
  const Workplace place;
  place.replace_line("devices/thimble-3rrs.toml", "port", "port = \"/dev/ttyNOTTHERE\"");
  const ProgramRun run =
      run_program({"run", place.path("scenes/plane.toml"), "--headless", "--as-fast-as-possible",
                   "--duration-s", "0.1", "--wait-for-device", "--json"});
  EXPECT_EQ(run.status, 0) << run.errors;
  // While it waits, and at the end.
  EXPECT_THAT(run.errors, HasSubstr("port /dev/ttyNOTTHERE cannot be opened: "));
  EXPECT_THAT(run.errors, HasSubstr("finger index: port /dev/ttyNOTTHERE was not to be opened to "
                                    "the end"));
  EXPECT_EQ(std::ranges::count(run.errors, '\n'), 2) << run.errors;
}

TEST(BadInput, PoseFileIsNamedWithItsLine) {
  const Workplace place;
  place.write("poses.csv",
              "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,40,1,0,0,0\n0.1,0,0,forty,1,0,0,0\n");
  expect_refused({"run", place.path("scenes/plane.toml"), "--headless", "--tracker",
                  "csv:" + place.path("poses.csv")},
                 {"poses.csv:3:", "z_mm"});
}

TEST(BadInput, WrongUsage) {
  const std::string scene = source_folder() + "/scenes/plane.toml";
  const std::string finger = source_folder() + "/fingers/index.toml";
  const std::string device = source_folder() + "/devices/thimble-3rrs.toml";
  expect_refused({}, {});
  expect_refused({"explode"}, {"explode"});
  expect_refused({"run"}, {"SCENE"});
  expect_refused({"run", scene, "--loudly"}, {"--loudly"});
  expect_refused({"run", scene, "--headless", "--duration-s", "soon"}, {"--duration-s soon: not"});
  for (const std::string port : {"70000", "-1", "http", "1.5", "999999999999999999999"}) {
    expect_refused({"run", scene, "--port", port}, {"--port " + port + ": ", "0 to 65535"});
    expect_refused({"emulate", "udp", finger, "--port", port}, {"--port " + port, "1 to 65535"});
  }
  expect_refused({"run", scene, "--headless", "--key", finger}, {"--key: a headless run"});
  expect_refused({"run", scene, "--headless", "--certificate", finger}, {"--certificate: a head"});
  expect_refused({"run", scene, "--port", "0", "--certificate", "/nowhere.pem", "--key", finger},
                 {"--certificate /nowhere.pem: no such file"});
  expect_refused({"run", scene, "--port", "0", "--certificate", finger, "--key", "/nowhere.pem"},
                 {"--key /nowhere.pem: no such file"});
  expect_refused({"run", scene, "--headless", "--duration-s", "-1"}, {"--duration-s"});
  expect_refused({"run", scene, "--headless", "--duration-s", "nan"}, {"--duration-s"});
  expect_refused({"run", scene, "--headless", "--simd", "abacus"}, {"abacus"});
  expect_refused({"run", scene, "--headless", "--person", "/nobody.toml"}, {"/nobody.toml"});
  expect_refused({"evaluate", scene, "--person", scene}, {"plane.toml:", "description"});
  expect_refused({"press", finger, "--to-mm", "-1"}, {"--to-mm"});
  expect_refused({"press", finger, "--steps", "0"}, {"--steps"});
  expect_refused({"press", finger, "--sphere-mm", "nan"}, {"--sphere-mm"});
  expect_refused({"press", finger, "--hold-ms", "-1"}, {"--hold-ms"});
  expect_refused({"press", finger, "--hold-ms", "5"}, {"--hold-ms", "--speed-mm-per-s"});
  expect_refused({"device", "solve", device, "--configuration", "yaw_deg=5"},
                 {"--configuration", "yaw_deg"});
  expect_refused({"device", "pose", device, "--joints-deg", "1,2"}, {"--joints-deg"});
  expect_refused({"device", "pose", device, "--joints-mm", "1,2,3"}, {"--joints-deg"});
  expect_refused({"device", "schema", "pin_arrow"}, {"pin_array", "membrane"});
}

TEST(BadInput, PoseOutsideTheWorkspaceIsAnAnswer) {
  const ProgramRun run =
      run_program({"device", "solve", source_folder() + "/devices/thimble-3rrs.toml",
                   "--configuration", "pitch_deg=80,roll_deg=0,travel_mm=0", "--json"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("\"reachable\""));
  EXPECT_THAT(run.output, HasSubstr("false"));
}

// --- Device and finger
// ----------------------------------------------------------------------------

TEST(BadInput, ADeviceInsideTheBoneIsRefused) {
  const Workplace place;
  const std::string device = "devices/thimble-3rrs.toml";
  const std::string scene = place.path("scenes/plane.toml");
  const std::vector<std::string> run{"run", scene, "--headless", "--as-fast-as-possible"};
  place.replace_line(device, "clearance_mm", "");
  int line = place.replace_line(device, "translation_mm", "translation_mm = [2.0, 0.5, -1.0]");
  const std::vector<std::string> words{"thimble-3rrs.toml:" + std::to_string(line),
                                       "mount.translation_mm", "bone", "index.toml"};
  expect_refused(run, words);
  expect_refused({"evaluate", scene}, words);
  // The mount is well, but home is not.
  place.replace_line(device, "translation_mm", "translation_mm = [1.0, 0.0, -10.3]");
  place.replace_line(device, "travel_mm = 0.0", "travel_mm = 9.5");
  line = place.replace_line(device, "[home]", "[home]");
  expect_refused(run, {"thimble-3rrs.toml:" + std::to_string(line), "home", "bone", "index.toml"});
}

TEST(BadInput, AHomeThatPressesTheSkinIsRefused) {
  const Workplace place;
  const std::string device = "devices/thimble-3rrs.toml";
  place.replace_line(device, "travel_mm = 0.0", "travel_mm = 5.0");
  const int line = place.replace_line(device, "[home]", "[home]");
  expect_refused({"run", place.path("scenes/plane.toml"), "--headless", "--as-fast-as-possible"},
                 {"thimble-3rrs.toml:" + std::to_string(line), "home", "presses", "index.toml"});
}

TEST(BadInput, ForceOfADeviceThatNothingAdvances) {
  const Workplace place;
  const std::string device = "devices/five-bar.toml";
  // By its servos, of which neither leads it to the finger.
  place.replace_line(device, "x_mm =", "first_deg = { joint = \"distal_servo\" }");
  place.replace_line(device, "z_mm = {", "second_deg = { joint = \"proximal_servo\" }");
  const std::string rest = "first_deg = 59.2\nsecond_deg = 59.2\n";
  place.replace_line(device, "z_mm = -3.0", rest + "[home]\n" + rest);
  const std::vector<std::string> run{"run",        place.path("scenes/plane.toml"),
                                     "--device",   place.path(device),
                                     "--headless", "--as-fast-as-possible"};
  expect_refused(run,
                 {"five-bar.toml:", "limits.max_force_N", "[matching] approach", "leave it out"});
  place.replace_line(device, "max_force_N", "");
  place.write(device, place.read(device) + "\n[force_sensor]\nkind = \"emulator\"\n");
  expect_refused(
      run, {"five-bar.toml:", "force_sensor.kind", "[matching] approach", "leave the table out"});
}

}  // namespace
}  // namespace softfinger
