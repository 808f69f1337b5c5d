#include "softfinger/study/vary_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMostValues = 10'000;

/// What a [vary] table's leaf may say.
constexpr std::array kLeafKeys{"min", "max", "log", "count", "values", "tie"};

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

/// Formulas of ties come last, when all parameters are known.
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

}  // namespace

void read_vary(const ConfigTable& vary, Study& study, FileNumbers& numbers) {
  VaryReader(study, numbers).read(vary);
}

}  // namespace softfinger
