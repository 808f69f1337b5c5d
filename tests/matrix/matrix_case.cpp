#include "matrix_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_size.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFingers{
    "index", "thumb", "middle", "ring", "pinky", "index-layered", "index-viscoelastic"};
// Those that differ by their motors alone move as one.
constexpr std::array kDevices{
    "thimble-3rrs", "cable-prattichizzo",  "delta-schorr",          "five-bar",
    "membrane",     "pins-sarakoglou-4x4", "pins-wagner-6x6",       "plate-2dof",
    "plate-6dof",   "roller-provancher",   "thimble-3rrs-mechanism"};
constexpr std::array kObjectives{"surface", "surface_and_force", "surface", "surface_and_force",
                                 "stress"};
constexpr std::array kScenes{"plane", "sphere", "edge", "corner", "cylinder", "relief"};
constexpr int kSizes = 40;
constexpr double kSpread = 0.06;    // of sizes of fingers, part of the mean
constexpr double kExtreme = 2.326;  // the 1st and the 99th of a hundred

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

fs::path source() { return source_folder(); }

}  // namespace

std::ostream& operator<<(std::ostream& out, const MatrixCase& one) {
  out << fmt::format("{} x ({:.3f}, {:.3f}, {:.3f}) on {}, {}, ", one.finger, one.scale.x(),
                     one.scale.y(), one.scale.z(), one.device, one.objective);
  if (!one.scene.empty()) return out << "scene " << one.scene;
  return out << fmt::format("tap of {:.2f} s, pitch {:.0f} deg", one.tap_s, one.pitch_deg);
}

std::vector<MatrixCase> matrix_cases(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0.0, 1.0);
  const auto drawn = [&] { return std::clamp(normal(random), -kExtreme, kExtreme); };
  std::vector<MatrixCase> cases;
  for (const char* finger : kFingers) {
    for (const char* device : kDevices) {
      cases.push_back({.finger = finger, .device = device});
    }
  }
  for (int k = 0; k < kSizes; ++k) {
    MatrixCase one{.finger = "index",
                   .device = kDevices[static_cast<std::size_t>(k) % kDevices.size()]};
    const double common = drawn();  // long fingers are broad and deep as well
    for (double& scale : one.scale) {
      scale = 1.0 + kSpread * std::clamp(0.8 * common + 0.6 * drawn(), -kExtreme, kExtreme);
    }
    cases.push_back(one);
  }
  std::shuffle(cases.begin(), cases.end(), random);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    MatrixCase& one = cases[k];
    one.objective = kObjectives[k % kObjectives.size()];
    if (k % 4 == 3) one.scene = kScenes[(k / 4) % kScenes.size()];
    one.tap_s = 0.1 * std::pow(10.0, even(random));
    one.pitch_deg = std::floor(12.0 * even(random));
  }
  return cases;
}

fs::path write_scene(const MatrixCase& one, const fs::path& folder) {
  const fs::path shipped = source() / "fingers" / (one.finger + ".toml");
  const FingerSize size = finger_size(*FingerModel::load(shipped));
  std::string finger = text_of(shipped);
  finger = std::regex_replace(finger, std::regex("file = \"([^\"]*)\""),
                              fmt::format("file = \"{}/$1\"", (source() / "fingers").string()));
  finger = std::regex_replace(finger, std::regex("\\[size\\][^\\[]*"), "");
  finger += fmt::format("\n[size]\nlength_mm = {}\nbreadth_mm = {}\ndepth_mm = {}\n",
                        *size.length * one.scale.x() / mm, *size.breadth * one.scale.y() / mm,
                        *size.depth * one.scale.z() / mm);
  std::ofstream(folder / "finger.toml") << finger;

  std::string scene;
  if (!one.scene.empty()) {
    scene = text_of(source() / "scenes" / (one.scene + ".toml"));
    scene = std::regex_replace(scene, std::regex("model = \"[^\"]*\""), "model = \"finger.toml\"");
    scene =
        std::regex_replace(scene, std::regex("device = \"[^\"]*\""), "device = \"device.toml\"");
    scene =
        std::regex_replace(scene, std::regex("\"\\.\\./"), fmt::format("\"{}/", source().string()));
  } else {
    // From well above to about 1.3 mm of indentation, where it stays, and back.
    const double top = 0.5 * *size.depth * one.scale.z() + 13.0 * mm;
    const double low = 0.5 * *size.depth * one.scale.z() - 1.6 * mm;
    const double down = 0.2 + one.tap_s;
    const double up = down + 0.35;
    scene = "[[finger]]\nname = \"index\"\nmodel = \"finger.toml\"\ndevice = \"device.toml\"\n";
    for (const auto& [time, height] :
         {std::pair{0.0, top}, std::pair{0.2, top}, std::pair{down, low}, std::pair{up, low},
          std::pair{up + one.tap_s, top}, std::pair{up + one.tap_s + 0.3, top}}) {
      scene += fmt::format(
          "[[finger.waypoint]]\ntime_s = {}\nposition_mm = [0.0, 0.0, {}]\n"
          "rotation_vector_deg = [0.0, {}, 0.0]\n",
          time, height / mm, one.pitch_deg);
    }
    scene += "[[object]]\nname = \"plane\"\nshape = \"plane\"\nfriction_coefficient = 0.5\n";
  }
  std::ofstream(folder / "scene.toml") << scene;
  fs::copy_file(source() / "devices" / (one.device + ".toml"), folder / "device.toml");
  return folder / "scene.toml";
}

}  // namespace softfinger
