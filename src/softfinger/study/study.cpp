#include "softfinger/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/study/named_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::array<NameRow<VariedFile>, 3> kVariedFiles{{
    {VariedFile::kDevice, "device"},
    {VariedFile::kFinger, "finger"},
    {VariedFile::kScene, "scene"},
}};
constexpr int kMostDesigns = 10'000'000;
constexpr int kMostGenerations = 100'000;
constexpr std::size_t kMostValues = 10'000;

/// What a [vary] table's leaf may say.
constexpr std::array kLeafKeys{"min", "max", "log", "count", "values", "tie"};

StudyFile open_file(const fs::path& path, const std::string& written) {
  return {path, written, TomlText(path, read_text_file(path, ConfigFile::kMaxSize))};
}

/// The study's files, read.
void read_files(const ConfigTable& root, Study& study) {
  const fs::path directory = study.file.parent_path();
  if (root.has("scene") && root.has("scenes")) {
    root.fail("scenes", "stands instead of scene; leave one out");
  }
  std::vector<std::string> scenes;
  if (const auto scene = root.optional_text("scene")) scenes.push_back(*scene);
  if (root.has("scenes")) scenes = root.texts("scenes");
  const char* key = root.has("scenes") ? "scenes" : "scene";
  for (const std::string& word : scenes) {
    study.scenes.push_back(named_file(root, key, Shipped::kScene, directory, word));
    const StudyFile& file = study.scenes.back();
    const Scene scene = load_scene(file.path, file.text.text());
    if (scene.fingers.size() != 1) {
      root.fail(key,
                fmt::format("{}: has {} fingers; a study is of one", word, scene.fingers.size()));
    }
    const fs::path& finger = scene.fingers.front().model;
    if (study.finger && !fs::equivalent(study.finger->path, finger)) {
      root.fail(key,
                fmt::format("{}: is touched by {}, and {} by {}; a study is of one finger", word,
                            finger.string(), scenes.front(), study.finger->path.string()));
    }
    if (!study.finger) {
      study.finger = open_file(
          finger,
          finger.lexically_normal().lexically_proximate(directory.lexically_normal()).string());
    }
  }
}

/// Numbers of a file as its reader has them, by their ways: those that it leaves out as well.
void flatten(const std::string& way, const Json& value, std::map<std::string, double>& numbers) {
  if (value.is_number()) numbers[way] = value.get<double>();
  if (!value.is_structured()) return;
  std::size_t index = 0;
  for (auto entry = value.begin(); entry != value.end(); ++entry, ++index) {
    const std::string key = value.is_object() ? entry.key() : std::to_string(index);
    flatten(way.empty() ? key : fmt::format("{}.{}", way, key), *entry, numbers);
  }
}

/// The numbers of a study's files by their keys, "device.geometry.crank_mm".
class FileNumbers {
 public:
  explicit FileNumbers(Study& study) : study_(study) {}

  /// There is this number in each file it is about, from now on. Empty: there is none.
  std::optional<double> find(VariedFile file, const std::string& way) {
    std::optional<double> value;
    for (StudyFile* each : files(file)) {
      std::optional<double> here = each->text.number(way);
      if (!here) {
        const auto left_out = defaults(file).find(way);
        if (left_out != defaults(file).end() && each->text.add(way, left_out->second)) {
          here = left_out->second;
        }
      }
      if (!here) return {};
      if (!value) value = here;
    }
    return value;
  }

  [[nodiscard]] std::string nearest(VariedFile file, const std::string& way) {
    std::vector<std::string> ways;
    for (StudyFile* each : files(file)) {
      const std::vector<std::string> own = each->text.ways();
      ways.insert(ways.end(), own.begin(), own.end());
    }
    for (const auto& [left_out, value] : defaults(file)) ways.push_back(left_out);
    return nearest_word(way, ways);
  }

  [[nodiscard]] std::vector<StudyFile*> files(VariedFile file) {
    if (file == VariedFile::kDevice) return {&study_.device};
    if (file == VariedFile::kFinger) {
      return study_.finger ? std::vector<StudyFile*>{&*study_.finger} : std::vector<StudyFile*>{};
    }
    std::vector<StudyFile*> scenes;
    for (StudyFile& scene : study_.scenes) scenes.push_back(&scene);
    return scenes;
  }

 private:
  const std::map<std::string, double>& defaults(VariedFile file) {
    auto& numbers = defaults_[static_cast<std::size_t>(file)];
    if (numbers) return *numbers;
    numbers.emplace();
    std::string as_read = "{}";
    if (file == VariedFile::kDevice) {
      const auto device = load_device(study_.device.path, study_.device.text.text(), 0.0);
      as_read = device->settings().as_read;
    } else if (file == VariedFile::kFinger && study_.finger) {
      as_read = FingerModel::load(study_.finger->path, study_.finger->text.text())->as_read;
    }
    flatten("", Json::parse(as_read), *numbers);
    return *numbers;
  }

  Study& study_;
  std::array<std::optional<std::map<std::string, double>>, 3> defaults_;
};

/// Splits "device.geometry.crank_mm" after the file's name; null where it begins with none.
const NameRow<VariedFile>* file_of(std::string_view key, std::string& way) {
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return nullptr;
  way = key.substr(dot + 1);
  return row_named(kVariedFiles, key.substr(0, dot));
}

/// What names in formulas stand for: parameters, and all other numbers of the files.
Expression::Names names_in(const Study& study, FileNumbers& numbers) {
  return [&study, &numbers](std::string_view name) -> std::optional<Expression::Meaning> {
    for (std::size_t i = 0; i < study.parameters.size(); ++i) {
      if (study.parameters[i].key == name) return Expression::Meaning{.variable = i};
    }
    std::string way;
    const auto* file = file_of(name, way);
    if (file == nullptr) return {};
    const auto value = numbers.find(file->value, way);
    if (!value) return {};
    return Expression::Meaning{.constant = *value};
  };
}

bool is_leaf(const ConfigTable& table) {
  return std::ranges::any_of(
      kLeafKeys, [&](const char* key) { return table.has(key) && !table.has_table(key); });
}

/// What a grid makes of a range.
std::vector<double> even_steps(const Parameter& range, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    values.push_back(range.at(static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return values;
}

Parameter read_leaf(const ConfigTable& table, const std::string& key, bool in_grid) {
  Parameter parameter;
  parameter.key = key;
  const bool ranges = table.has("min") || table.has("max");
  if (static_cast<int>(ranges) + static_cast<int>(table.has("values")) +
          static_cast<int>(table.has("tie")) >
      1) {
    table.fail("", "takes one of min and max, values, or tie");
  }
  if (table.has("values")) {
    const Eigen::VectorXd values = table.some_numbers("values", 1, kMostValues);
    parameter.values.assign(values.begin(), values.end());
    std::set<double> different(values.begin(), values.end());
    if (different.size() != parameter.values.size()) table.fail("values", "has a value twice");
    return parameter;
  }
  parameter.min = table.number("min");
  parameter.max = table.number("max");
  if (!(parameter.min < parameter.max)) {
    table.fail("max", fmt::format("must be more than min, {:.6g}, found {:.6g}: the range is empty",
                                  parameter.min, parameter.max));
  }
  parameter.log = table.boolean("log", false);
  if (parameter.log && !(parameter.min > 0.0)) {
    table.fail("min", "must be above 0 where log = true");
  }
  if (table.has("count") && !in_grid) {
    table.fail("count", "is of a grid; other designs take any number in the range");
  }
  if (in_grid) {
    if (!table.has("count")) {
      table.fail("", "a grid needs values = [...], or how many even steps: count");
    }
    parameter.values = even_steps(parameter, table.integer("count", 2, kMostValues));
  }
  return parameter;
}

/// The parameters in the order of the file, ties without their formulas, which are returned.
class VaryReader {
 public:
  VaryReader(Study& study, FileNumbers& numbers) : study_(study), numbers_(numbers) {}

  void read(const ConfigTable& vary) {
    for (const std::string& name : vary.keys()) {
      const auto* file = row_named(kVariedFiles, name);
      if (file == nullptr) {
        vary.fail(name,
                  "expected a key of device, finger or scene, as in device.geometry.crank_mm");
      }
      descend(vary.table(name), name);
    }
    if (study_.parameters.empty()) vary.fail("", "names nothing to vary");
    if (std::ranges::none_of(study_.parameters, &Parameter::is_free)) {
      vary.fail("", "ties all and leaves nothing to vary");
    }
    for (const auto& [index, table] : ties_) tie(index, table);
  }

 private:
  void descend(const ConfigTable& table, const std::string& key) {
    for (const std::string& name : table.keys()) {
      const std::string below = fmt::format("{}.{}", key, name);
      const ConfigTable child = table.table(name);
      table.any_name(name);
      if (is_leaf(child)) {
        leaf(child, below);
      } else if (child.keys().empty()) {
        child.fail("", "needs min and max, values, or tie");
      } else {
        descend(child, below);
      }
    }
  }

  void leaf(const ConfigTable& table, const std::string& key) {
    std::string way;
    const auto* file = file_of(key, way);
    if (numbers_.files(file->value).empty()) {
      table.fail("", "there is no scene, and so nothing of that kind to vary");
    }
    if (!numbers_.find(file->value, way)) {
      const std::string near = numbers_.nearest(file->value, way);
      const StudyFile& where = *numbers_.files(file->value).front();
      table.fail(
          "", fmt::format("{} has no number of this key{}", where.written,
                          near.empty() ? "; a key that has no default must be in the file "
                                         "to be varied"
                                       : fmt::format("; did you mean {}.{}?", file->name, near)));
    }
    for (const Parameter& other : study_.parameters) {
      const auto same = [&](const StudyFile* each) { return each->text.is_same(other.way, way); };
      if (other.file == file->value && std::ranges::any_of(numbers_.files(file->value), same)) {
        table.fail("", fmt::format("is the same number as {}", other.key));
      }
    }
    if (table.has("tie")) {
      ties_.emplace_back(study_.parameters.size(), table);
      study_.parameters.push_back({.key = key});
      study_.parameters.back().tie =
          std::make_shared<const Expression>("0", [](std::string_view) { return std::nullopt; });
    } else {
      study_.parameters.push_back(read_leaf(table, key, study_.plan.kind == DesignKind::kGrid));
    }
    study_.parameters.back().file = file->value;
    study_.parameters.back().way = way;
  }

  /// May name what is free, and ties before it.
  void tie(std::size_t index, const ConfigTable& table) {
    const auto names = names_in(study_, numbers_);
    const auto allowed = [&](std::string_view name) -> std::optional<Expression::Meaning> {
      const auto meaning = names(name);
      if (meaning && meaning->variable != Expression::Meaning::kNone &&
          meaning->variable >= index && !study_.parameters[meaning->variable].is_free()) {
        throw InputError(fmt::format("{} is tied itself, and not before", name));
      }
      return meaning;
    };
    try {
      study_.parameters[index].tie = std::make_shared<const Expression>(table.text("tie"), allowed);
    } catch (const InputError& error) {
      table.fail("tie", error.what());
    }
  }

  Study& study_;
  FileNumbers& numbers_;
  std::vector<std::pair<std::size_t, ConfigTable>> ties_;
};

Over read_over(const ConfigTable& table, const char* key) {
  return row_named(kOvers, table.choice(key, names_of(kOvers), "mean"))->value;
}

std::string read_measure(const ConfigTable& table) {
  std::string measure = table.text("measure");
  const std::vector<std::string> words = measure_words();
  if (std::ranges::find(words, measure) != words.end()) return measure;
  const std::vector<std::string> near = names_near(measure, words);
  table.fail(
      "measure",
      near.size() < words.size()
          ? fmt::format("no measure is called '{}'; did you mean {}?", measure, listed(near, "or"))
          : fmt::format("no measure is called '{}'; expected a number of evaluate --json "
                        "that is not a time, such as stress_error or lagged.iou",
                        measure));
}

Quantity read_quantity(const ConfigTable& table, const std::string& name, Study& study,
                       FileNumbers& numbers) {
  Quantity quantity;
  quantity.name = name;
  if (table.has("measure") == table.has("formula")) {
    table.fail("", "needs a measure, or a formula instead");
  }
  if (table.has("formula")) {
    try {
      quantity.formula =
          std::make_shared<const Expression>(table.text("formula"), names_in(study, numbers));
    } catch (const InputError& error) {
      table.fail("formula", error.what());
    }
    return quantity;
  }
  quantity.measure = read_measure(table);
  if (study.scenes.empty()) table.fail("measure", "needs a scene in which to measure it");
  quantity.over_people = read_over(table, "over_people");
  quantity.over_frames = read_over(table, "over_frames");
  return quantity;
}

/// Names are columns of tables.
void check_name(const ConfigTable& table, const std::string& name, const Study& study) {
  const bool plain = std::ranges::all_of(
      name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (!plain || name.empty() || name.size() > 64) {
    table.fail(name, "expected a name of 1 to 64 letters, digits, - or _");
  }
  if (name == "design" || name == "feasible" || name == "reason") {
    table.fail(name, "is a column of every study; choose another name");
  }
  for (const Quantity* other : study.quantities()) {
    if (other->name == name) table.fail(name, "is an objective's name as well; choose another");
  }
}

void read_quantities(const ConfigTable& root, Study& study, FileNumbers& numbers) {
  const ConfigTable objectives = root.table("objectives");
  for (const std::string& name : objectives.keys()) {
    check_name(objectives, name, study);
    const ConfigTable table = objectives.table(name);
    Quantity objective = read_quantity(table, name, study, numbers);
    objective.maximise = table.boolean("maximise", false);
    objectives.any_name(name);
    study.objectives.push_back(std::move(objective));
  }
  if (study.objectives.empty()) objectives.fail("", "names no objective");
  const auto constraints = root.optional_table("constraints");
  if (!constraints) return;
  for (const std::string& name : constraints->keys()) {
    check_name(*constraints, name, study);
    const ConfigTable table = constraints->table(name);
    Quantity constraint = read_quantity(table, name, study, numbers);
    constraint.at_least = table.optional_number("at_least");
    constraint.at_most = table.optional_number("at_most");
    if (!constraint.at_least && !constraint.at_most) {
      table.fail("", "needs at_most or at_least");
    }
    if (constraint.at_least && constraint.at_most && constraint.over_people != Over::kMean) {
      table.fail("over_people", "of what has bounds on both sides must be the mean");
    }
    constraint.maximise = constraint.at_least.has_value();
    constraints->any_name(name);
    study.constraints.push_back(std::move(constraint));
  }
}

DesignPlan read_plan(const ConfigTable& table) {
  DesignPlan plan;
  const DesignKindRow& row = *row_named(kDesignKinds, table.choice("kind", names_of(kDesignKinds)));
  table.decides("kind");
  plan.kind = row.value;
  plan.seed = static_cast<std::uint32_t>(table.integer("seed", 0, 2147483647, 1));
  if (plan.kind == DesignKind::kGrid) {
    for (const char* key : {"size", "generations"}) {
      if (table.has(key)) table.fail(key, "a grid takes every combination; leave this out");
    }
    return plan;
  }
  plan.size = static_cast<std::size_t>(table.integer("size", 1, kMostDesigns));
  if (row.searches) {
    plan.generations = static_cast<std::size_t>(table.integer("generations", 1, kMostGenerations));
  } else if (table.has("generations")) {
    table.fail("generations", fmt::format("is of a search, and {} is none", row.name));
  }
  if (plan.kind == DesignKind::kGaco && plan.size < 8) {
    table.fail("size", fmt::format("of gaco must be 8 or more, found {}", plan.size));
  }
  if (plan.kind == DesignKind::kNsga2 && (plan.size < 8 || plan.size % 4 != 0)) {
    table.fail("size",
               fmt::format("of nsga2 must be 8 or more and a multiple of 4, found {}", plan.size));
  }
  return plan;
}

/// What can only be said of all together.
void check_plan(const ConfigTable& root, Study& study) {
  const ConfigTable design = root.table("design");
  if (study.plan.kind == DesignKind::kNsga2 && study.objectives.size() < 2) {
    design.fail("kind", "nsga2 wants two objectives or more; for one there is gaco");
  }
  if (study.plan.kind == DesignKind::kGaco && study.objectives.size() != 1) {
    design.fail("kind", "gaco wants one objective; for more there is nsga2");
  }
  if (study.plan.kind != DesignKind::kGrid) return;
  double combinations = 1.0;
  for (const Parameter& parameter : study.parameters) {
    if (parameter.is_free()) combinations *= static_cast<double>(parameter.values.size());
  }
  if (combinations > kMostDesigns) {
    design.fail("kind", fmt::format("the grid has {:.3g} designs, more than {}", combinations,
                                    kMostDesigns));
  }
  study.plan.size = static_cast<std::size_t>(combinations);
}

}  // namespace

StudyFile named_file(const ConfigTable& table, const char* key, Shipped kind,
                     const fs::path& directory, const std::string& word) {
  const fs::path beside = directory / word;
  std::error_code error;
  try {
    return open_file(fs::exists(beside, error) ? beside : file_or_shipped(kind, word), word);
  } catch (const InputError& refusal) {
    table.fail(key, refusal.what());
  }
}

std::vector<const Quantity*> Study::quantities() const {
  std::vector<const Quantity*> all;
  for (const Quantity& each : objectives) all.push_back(&each);
  for (const Quantity& each : constraints) all.push_back(&each);
  return all;
}

std::vector<std::string> Study::measures() const {
  std::vector<std::string> measures;
  for (const Quantity* quantity : quantities()) {
    if (!quantity->measure.empty()) measures.push_back(quantity->measure);
  }
  return measures;
}

Study load_study(const fs::path& file) {
  const std::string text = read_text_file(file, ConfigFile::kMaxSize);
  const ConfigFile config(file, text);
  const ConfigTable root = config.root();
  const std::string device = root.text("device");
  Study study{.file = file,
              .text = text,
              .device = named_file(root, "device", Shipped::kDevice, file.parent_path(), device)};
  read_files(root, study);
  if (root.has("objective")) {
    study.objective = objective_kind(root.choice("objective", objective_words()));
  }
  study.plan = read_plan(root.table("design"));
  FileNumbers numbers(study);
  VaryReader(study, numbers).read(root.table("vary"));
  if (const auto population = root.optional_table("population")) {
    study.population = read_population(*population);
    if (study.scenes.empty() && study.population.size > 1) {
      population->fail("size", "there is no scene, and so nobody who touches");
    }
  }
  read_quantities(root, study, numbers);
  root.finish();
  check_plan(root, study);
  return study;
}

}  // namespace softfinger
