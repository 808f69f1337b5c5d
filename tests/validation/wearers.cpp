// Drawn wearers put a device on that learns them, each unlike its model in everything: another
// mesh, skin that relaxes by more or less, friction, a sensor with noise, gain and delay, a device
// with play and put on askew.
//
//     softfinger_wearers SOURCE_FOLDER [--wearers N] [--first N] [--noise-N S] [--seed N]
//                        [--others N] [--unlike LIST] [--hysteresis PART]
//
// Prints one JSON object a wearer and line: error of the normal force on a plane and a sphere
// with the fit, by its sign too, what the fit says of itself, and its cost. --others: of the first
// N also with nothing known, with sizes alone, with the travel offset of a run, by touches that
// they tell, and with all traits known as they are. --unlike: of
// mesh,relaxation,friction,noise,gain,play,late these alone; none. --hysteresis: of the sensor.

#include <fmt/format.h>
#include <stdlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>

#include "../support/table_rest.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/person/person_registration.hpp"
#include "softfinger/session/device_fit.hpp"
#include "softfinger/session/evaluation.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace {

using namespace softfinger;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kEvaluated = 4.0;  // s of a scene
constexpr double kPlay = 0.1 * mm;
constexpr double kQuiet = 0.002;  // N
/// X_BodyFt of what a tracker follows, and how well a finger lies on a table in each posture.
const Pose kBody{exp_rotation({0.2, 1.3, -0.4}), {3.0 * mm, 1.0 * mm, -14.0 * mm}};
constexpr double kLean = 2.0 * deg;
constexpr double kHeightNoise = 0.1 * mm;

/// What a drawn wearer has besides the traits that are looked for.
struct Unlike {
  bool mesh = true, relaxation = true, friction = true, noise = true, gain = true, play = true,
       late = true;

  static Unlike of(const std::string& list) {
    const auto has = [&](const char* word) { return list.find(word) != std::string::npos; };
    return {has("mesh"), has("relaxation"), has("friction"), has("noise"),
            has("gain"), has("play"),       has("late")};
  }
};

struct Arguments {
  fs::path source;
  int wearers = 20;
  double noise = 0.05;  // N
  unsigned seed = 1;
  int others = 0;
  double hysteresis = 0.0;
  Unlike unlike;
};

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

class Wearers {
 public:
  explicit Wearers(const Arguments& arguments) : arguments_(arguments) {
    std::string pattern = (fs::temp_directory_path() / "softfinger-wearers-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw OperationError(pattern + ": cannot be created");
    folder_ = pattern;
    const std::string model =
        with_meshes_of(arguments.source / "fingers", "index.toml") + relaxation(1.0);
    std::ofstream(folder_ / "model.toml") << model;
    finger_ = FingerModel::load(folder_ / "model.toml");
    for (const char* scene : {"plane", "sphere"}) {
      const std::regex finger("\"\\.\\./fingers/index\\.toml\"");
      const std::regex other("\"\\.\\./");
      const std::string text =
          text_of(arguments.source / "scenes" / (std::string(scene) + ".toml"));
      std::ofstream(folder_ / (std::string(scene) + ".toml"))
          << std::regex_replace(std::regex_replace(text, finger, "\"model.toml\""), other,
                                fmt::format("\"{}/", arguments.source.string()));
    }
    device_ = arguments.source / "devices" / "thimble-3rrs.toml";
    sensing_ = folder_ / "sensing.toml";
    std::ofstream(sensing_) << text_of(device_)
                            << fmt::format(
                                   "\n[force_sensor]\nkind = \"emulator\"\nnoise_N = {}\n"
                                   "hysteresis = {}\n",
                                   noise(), arguments.hysteresis);
  }
  ~Wearers() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  void meet(int number) {
    std::seed_seq seeds{arguments_.seed, static_cast<unsigned>(number)};
    random_.seed(seeds);
    TraitVector x;
    for (int i = 0; i < kWearerTraits; ++i) x[i] = normal();
    const WearerTraits traits = WearerTraits::of(x);
    write_wearer(traits);

    const Unlike& unlike = arguments_.unlike;
    DeviceFitOptions fit;
    fit.device = sensing_;
    fit.finger = folder_ / "model.toml";
    fit.wearer = folder_ / "wearer.toml";
    fit.person = folder_ / "person.toml";
    fit.seed = static_cast<std::uint64_t>(number) + 1;
    fit.wear = {.mount = traits.mount_fit(),
                .friction_coefficient = 0.5 + (unlike.friction ? 0.2 : 0.0) * even(),
                .gain = 1.0 + (unlike.gain ? 0.03 : 0.0) * even(),
                .backlash = play(),
                .late = unlike.late ? 1 : 0};
    fs::remove(fit.person);
    const double tracked_before = register_on_table(fit.person);
    const double cpu_began = thread_cpu_time();
    double pressed = 0.0;
    fit.watch = [&pressed](const DeviceFitMoment& now) {
      if (now.estimating && !(pressed > 0.0)) pressed = thread_cpu_time();
    };
    const DeviceFit found = fit_device(fit, stop_);
    const double cpu_ended = thread_cpu_time();
    Json row{{"wearer", number},
             {"fitted", found.failure.empty()},
             {"failure", found.failure},
             {"cpu_s", cpu_ended - cpu_began},
             {"estimate_cpu_s", pressed > 0.0 ? cpu_ended - pressed : 0.0},
             {"duration_s", found.duration},
             {"presses", found.presses},
             {"delay_ms", found.delay / ms},
             {"max_force_N", found.greatest_force},
             {"predicted_force_error", found.estimate.predicted_force_error}};
    row["gain"] = fit.wear.gain;
    row["friction"] = fit.wear.friction_coefficient.value_or(0.5);
    row["true"] = Json::object();
    for (const WearerTraitRow& trait : kWearerTraitRows) {
      const auto i = static_cast<std::size_t>(trait.value);
      row["true"][std::string(trait.name)] =
          trait_value(trait.value, x[static_cast<Eigen::Index>(i)], *finger_) / trait.unit;
      if (found.traits.empty()) continue;
      const DeviceFit::Told& told = found.traits[i];
      row["found"][std::string(trait.name)] = {told.value / trait.unit, told.ci95_low / trait.unit,
                                               told.ci95_high / trait.unit};
    }
    if (found.registration) {
      row["tracked_mm"] = {
          tracked_before / mm,
          (found.registration->X_BodyFt.translation - kBody.translation).norm() / mm};
    }
    if (number < arguments_.others) row["touched"] = learns_by_touch(fit);
    for (const char* scene : {"plane", "sphere"}) {
      if (found.failure.empty()) {
        const Judged fitted = judge(scene, device_, traits, fit.person);
        row[scene] = {{"fit", fitted.error}, {"bias", fitted.bias}};
      }
      if (number >= arguments_.others) continue;
      row[scene]["nothing"] = force_error(scene, device_, traits, {});
      row[scene]["travel_offset"] = force_error(scene, sensing_, traits, {});
      if (row["touched"].get<std::string>().empty()) {
        row[scene]["touch"] = force_error(scene, device_, traits, folder_ / "touched.toml");
      }
      write_known(traits, false);
      row[scene]["sizes"] = force_error(scene, device_, traits, folder_ / "known.toml");
      write_known(traits, true);
      row[scene]["known"] = force_error(scene, device_, traits, folder_ / "known.toml");
    }
    std::cout << row.dump() << std::endl;
  }

 private:
  /// A body on the wearer's finger, registered on a table of known height from poses with noise,
  /// and no size: nothing else is known yet. Returns how far off that puts it, m.
  double register_on_table(const fs::path& file) {
    const auto finger = FingerModel::load(folder_ / "wearer.toml");
    std::vector<PostureCapture> captures = captures_of(*finger, kBody, 0.0);
    std::mt19937_64 random = random_;  // those of the fit stay as they were
    std::normal_distribution<double> normal;
    for (PostureCapture& capture : captures) {
      const Vector3 turn(normal(random), normal(random), normal(random));
      capture.up_Body = exp_rotation(kLean * turn) * capture.up_Body;
      capture.height += kHeightNoise * normal(random);
    }
    Person person = load_person_if_any(file);
    const Registration found = register_person(
        person,
        {.finger = "index", .model = folder_ / "model.toml", .measured = {}, .table_height = 0.0},
        captures);
    person.at("index").size = {};
    save_person(person);
    return (found.X_BodyFt.translation - kBody.translation).norm();
  }

  [[nodiscard]] double noise() const { return arguments_.unlike.noise ? arguments_.noise : kQuiet; }
  [[nodiscard]] double play() const { return arguments_.unlike.play ? kPlay : 0.0; }
  double normal() { return std::normal_distribution<double>()(random_); }
  double even() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }

  /// Into touched.toml; why not, or nothing.
  [[nodiscard]] std::string learns_by_touch(DeviceFitOptions fit) {
    fit.device = device_;
    fit.by_touch = true;
    fit.person = folder_ / "touched.toml";
    fs::remove(fit.person);
    return fit_device(fit, stop_).failure;
  }

  [[nodiscard]] FingerSize sizes(const WearerTraits& traits) const {
    const FingerSize own = finger_size(*finger_);
    return {.length = *own.length * traits.size_factor.x(),
            .breadth = *own.breadth * traits.size_factor.y(),
            .depth = *own.depth * traits.size_factor.z()};
  }

  [[nodiscard]] static std::string with_meshes_of(const fs::path& fingers, const char* file) {
    return std::regex_replace(text_of(fingers / file), std::regex("file = \"([^\"]*)\""),
                              fmt::format("file = \"{}\"", (fingers / "$1").string()));
  }

  /// What of index-viscoelastic acts within a press; its fastest part is over at once. `part` of
  /// it.
  [[nodiscard]] static std::string relaxation(double part) {
    return fmt::format(
        "\n[[material.relaxation]]\ntime_ms = 70.0\nfraction = {}\n"
        "\n[[material.relaxation]]\ntime_ms = 1400.0\nfraction = {}\n",
        0.209 * part, 0.104 * part);
  }

  /// The medium mesh, or the model's, with skin that relaxes by half or one and a half as much.
  void write_wearer(const WearerTraits& traits) {
    const char* file = arguments_.unlike.mesh ? "index-medium.toml" : "index.toml";
    std::string text = with_meshes_of(arguments_.source / "fingers", file);
    for (const char* key : {"youngs_modulus_kPa", "stiffness_kPa"}) {
      std::smatch found;
      const std::regex line(std::string(key) + " = ([0-9.]+)");
      if (!std::regex_search(text, found, line)) {
        throw OperationError(fmt::format("{}: no {}", file, key));
      }
      const double stiffness = traits.modulus_factor * std::stod(found[1]);
      text = std::regex_replace(text, line, fmt::format("{} = {}", key, stiffness));
    }
    text += relaxation(1.0 + (arguments_.unlike.relaxation ? 0.5 : 0.0) * even());
    const FingerSize size = sizes(traits);
    text += fmt::format("\n[size]\nlength_mm = {}\nbreadth_mm = {}\ndepth_mm = {}\n",
                        *size.length / mm, *size.breadth / mm, *size.depth / mm);
    std::ofstream(folder_ / "wearer.toml") << text;
  }

  /// Sizes, or all.
  void write_known(const WearerTraits& traits, bool all) {
    fs::remove(folder_ / "known.toml");
    Person person = load_person_if_any(folder_ / "known.toml");
    person.at("index").size = sizes(traits);
    if (all) {
      person.at("index").modulus_factor = traits.modulus_factor;
      person.at("index").mount = traits.mount_fit();
    }
    save_person(person);
  }

  /// Means of the normal force's error, of its magnitude and by its sign.
  struct Judged {
    double error = 1.0, bias = 0.0;
  };
  double force_error(const char* scene, const fs::path& device, const WearerTraits& traits,
                     const std::optional<fs::path>& person) {
    return judge(scene, device, traits, person).error;
  }
  Judged judge(const char* scene, const fs::path& device, const WearerTraits& traits,
               const std::optional<fs::path>& person) {
    EvaluationOptions options;
    options.run.scene = folder_ / (std::string(scene) + ".toml");
    options.run.devices = {device.string()};
    options.run.objective = objective_kind("surface_and_force");
    options.run.wearer = folder_ / "wearer.toml";
    // A device that presses is behind by half of its play.
    options.run.wearer_mount = traits.mount_fit();
    options.run.wearer_mount->translation.z() -= 0.5 * play();
    if (person && !person->empty()) options.run.person = *person;
    options.run.duration = kEvaluated;
    options.sides = {.lagged = false, .loaded = false, .depth = SkinComparison::Depth::kContact};
    try {
      const RenderingMeasures mean = evaluate(options, stop_).commanded.mean();
      if (std::isnan(mean.normal_force_error)) return {};  // never touched
      return {mean.normal_force_error, mean.normal_force_bias};
    } catch (const InputError&) {
      return {};  // a run refuses a device that would rest on the skin
    }
  }

  Arguments arguments_;
  fs::path folder_, device_, sensing_;
  std::shared_ptr<const FingerModel> finger_;
  std::mt19937_64 random_;
  std::atomic<bool> stop_{false};
};

}  // namespace

int main(int count, char** words) {
  Arguments arguments;
  int first = 0;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&] { return i + 1 < count ? std::atof(words[++i]) : 0.0; };
    if (word == "--wearers") {
      arguments.wearers = static_cast<int>(value());
    } else if (word == "--first") {
      first = static_cast<int>(value());
    } else if (word == "--noise-N") {
      arguments.noise = value();
    } else if (word == "--seed") {
      arguments.seed = static_cast<unsigned>(value());
    } else if (word == "--unlike") {
      arguments.unlike = Unlike::of(i + 1 < count ? words[++i] : "");
    } else if (word == "--hysteresis") {
      arguments.hysteresis = value();
    } else if (word == "--others") {
      arguments.others = static_cast<int>(value());
    } else {
      arguments.source = word;
    }
  }
  try {
    Wearers wearers(arguments);
    for (int i = first; i < first + arguments.wearers; ++i) wearers.meet(i);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
