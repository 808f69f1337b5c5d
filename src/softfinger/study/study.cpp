#include "softfinger/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/study/file_numbers.hpp"
#include "softfinger/study/named_file.hpp"
#include "softfinger/study/vary_file.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr int kMostDesigns = 10'000'000;
constexpr int kMostGenerations = 100'000;

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
    if (constraint.at_least && constraint.at_most && *constraint.at_least > *constraint.at_most) {
      table.fail("at_most", fmt::format("must be no less than at_least, {:g}: no design could be",
                                        *constraint.at_least));
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
  const bool is_path = word.find_first_of("/.") != std::string::npos;
  std::error_code error;
  try {
    return open_file(
        is_path || fs::is_regular_file(beside, error) ? beside : file_or_shipped(kind, word), word);
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
  read_vary(root.table("vary"), study, numbers);
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
