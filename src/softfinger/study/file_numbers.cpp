#include "softfinger/study/file_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "softfinger/device/device_file.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::json;

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

}  // namespace

const NameRow<VariedFile>* file_of(std::string_view key, std::string& way) {
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return nullptr;
  way = key.substr(dot + 1);
  return row_named(kVariedFiles, key.substr(0, dot));
}

std::optional<double> FileNumbers::find(VariedFile file, const std::string& way) {
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

std::string FileNumbers::nearest(VariedFile file, const std::string& way) {
  std::vector<std::string> ways;
  for (StudyFile* each : files(file)) {
    const std::vector<std::string> own = each->text.ways();
    ways.insert(ways.end(), own.begin(), own.end());
  }
  for (const auto& [left_out, value] : defaults(file)) ways.push_back(left_out);
  return nearest_word(way, ways);
}

std::vector<StudyFile*> FileNumbers::files(VariedFile file) {
  if (file == VariedFile::kDevice) return {&study_.device};
  if (file == VariedFile::kFinger) {
    return study_.finger ? std::vector<StudyFile*>{&*study_.finger} : std::vector<StudyFile*>{};
  }
  std::vector<StudyFile*> scenes;
  for (StudyFile& scene : study_.scenes) scenes.push_back(&scene);
  return scenes;
}

const std::map<std::string, double>& FileNumbers::defaults(VariedFile file) {
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

}  // namespace softfinger
