#include "softfinger/person/person.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/person/person_text.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostFingers = 64;
constexpr Range kOffset_mm{.min = -500.0, .max = 500.0};
constexpr Range kTurn_deg{.min = -360.0, .max = 360.0};
constexpr Range kModulusFactor{.min = 0.05, .max = 20.0};
constexpr Range kMount_mm{.min = -20.0, .max = 20.0};
constexpr Range kMountTurn_deg{.min = -60.0, .max = 60.0};
constexpr Range kHeight_mm{.min = -10000.0, .max = 10000.0};
constexpr Range kUp{.min = -1.001, .max = 1.001};
constexpr double kUnit = 1e-3;  // that a length may be off 1
constexpr int kPostureCount = static_cast<int>(RegistrationProcedure::kOrder.size());

Pose read_pose(const ConfigTable& table, const Range& offset, const Range& turn) {
  const Vector3 translation = table.numbers("translation_mm", 3, offset);
  const Vector3 rotation = table.numbers("rotation_vector_deg", 3, turn);
  return {exp_rotation(rotation), translation};
}

/// Empty where the table says nothing of it.
std::optional<TableRest> read_rest(const ConfigTable& table) {
  const auto up = table.optional_numbers("up", 3 * kPostureCount, kUp);
  const auto heights = table.optional_numbers("height_mm", kPostureCount, kHeight_mm);
  const auto table_height = table.optional_number("table_mm", kHeight_mm);
  const bool given = table.boolean("table_given", false);
  if (!up && !heights && !table_height) return std::nullopt;
  if (!up || !heights || !table_height) {
    table.fail(up ? heights ? "table_mm" : "height_mm" : "up",
               "missing; up, height_mm and table_mm go together");
  }
  TableRest rest{.captures = {}, .height = *table_height, .height_was_given = given};
  for (int k = 0; k < kPostureCount; ++k) {
    const Vector3 direction = up->segment<3>(3 * k);
    if (std::abs(direction.norm() - 1.0) > kUnit) {
      table.fail("up", fmt::format("direction {} of {} is not of length 1", k + 1, kPostureCount));
    }
    rest.captures.push_back(
        {.posture = RegistrationProcedure::kOrder.at(static_cast<std::size_t>(k)),
         .up_Body = direction,
         .height = (*heights)[k]});
  }
  return rest;
}

PersonFinger read_finger(const ConfigTable& table, const std::string& name) {
  PersonFinger finger;
  finger.name = name;
  if (const auto size = table.optional_table("size")) finger.size = read_finger_size(*size);
  if (const auto registration = table.optional_table("registration")) {
    finger.X_BodyFt = read_pose(*registration, kOffset_mm, kTurn_deg);
    finger.on_table = read_rest(*registration);
  }
  if (const auto tissue = table.optional_table("tissue")) {
    finger.modulus_factor = tissue->optional_number("modulus_factor", kModulusFactor);
  }
  if (const auto mount = table.optional_table("mount")) {
    finger.mount = read_pose(*mount, kMount_mm, kMountTurn_deg);
  }
  return finger;
}

Person read_person(const ConfigFile& config) {
  const ConfigTable root = config.root();
  Person person;
  for (const std::string& name : root.keys()) {
    if (!is_finger_name(name)) {
      root.fail(name, "no name of a finger; expected 1 to 64 letters, digits, - or _");
    }
    if (person.fingers.size() == kMostFingers) root.fail(name, "more than 64 fingers");
    person.fingers.push_back(read_finger(root.table(name), name));
    root.any_name(name, kFingerNamePattern);
  }
  root.finish();
  return person;
}

/// In the unit of a file, to a millionth of it: more than any measurement says.
std::string number(double value, double unit) {
  const double rounded = std::round(value / unit * 1e6) / 1e6;
  return fmt::format("{:.10g}", rounded == 0.0 ? 0.0 : rounded);
}

std::string numbers(const Vector3& value, double unit) {
  return fmt::format("[{}, {}, {}]", number(value.x(), unit), number(value.y(), unit),
                     number(value.z(), unit));
}

/// A key of [finger.table] with its value as TOML.
struct WrittenKey {
  std::string table, key, value;
  bool operator==(const WrittenKey&) const = default;
};

void add_pose(const std::string& table, const std::optional<Pose>& pose,
              std::vector<WrittenKey>& keys) {
  if (!pose) return;
  keys.push_back({table, "translation_mm", numbers(pose->translation, mm)});
  keys.push_back({table, "rotation_vector_deg", numbers(log_rotation(pose->rotation), deg)});
}

void add_rest(const TableRest& rest, std::vector<WrittenKey>& keys) {
  std::vector<std::string> up;
  std::vector<std::string> heights;
  for (const PostureCapture& capture : rest.captures) {
    for (const double part : capture.up_Body) up.push_back(number(part, 1.0));
    heights.push_back(number(capture.height, mm));
  }
  keys.push_back({"registration", "up", fmt::format("[{}]", fmt::join(up, ", "))});
  keys.push_back({"registration", "height_mm", fmt::format("[{}]", fmt::join(heights, ", "))});
  keys.push_back({"registration", "table_mm", number(rest.height, mm)});
  keys.push_back({"registration", "table_given", rest.height_was_given ? "true" : "false"});
}

std::vector<WrittenKey> keys_of(const PersonFinger& finger) {
  std::vector<WrittenKey> keys;
  const auto& [length, breadth, depth] = finger.size;
  if (length) keys.push_back({"size", "length_mm", number(*length, mm)});
  if (breadth) keys.push_back({"size", "breadth_mm", number(*breadth, mm)});
  if (depth) keys.push_back({"size", "depth_mm", number(*depth, mm)});
  add_pose("registration", finger.X_BodyFt, keys);
  if (finger.on_table) add_rest(*finger.on_table, keys);
  if (finger.modulus_factor) {
    keys.push_back({"tissue", "modulus_factor", number(*finger.modulus_factor, 1.0)});
  }
  add_pose("mount", finger.mount, keys);
  return keys;
}

/// All of a person, in a file that says nothing else.
std::string text_of(const Person& person) {
  std::string text =
      "# Fingers of one person: sizes, skin, how a device and a tracked body sit on them.\n";
  for (const PersonFinger& finger : person.fingers) {
    const std::vector<WrittenKey> keys = keys_of(finger);
    // A table that said nothing stays as well.
    if (keys.empty()) text += fmt::format("\n[{}]\n", finger.name);
    std::string table;
    for (const WrittenKey& key : keys) {
      if (key.table != table) text += fmt::format("\n[{}.{}]\n", finger.name, key.table);
      table = key.table;
      text += fmt::format("{} = {}\n", key.key, key.value);
    }
  }
  return text;
}

/// Whether this text says all of that, in whatever words.
bool says(const std::string& text, const Person& person) {
  try {
    const Person read = read_person(ConfigFile(person.file, text));
    return read.fingers.size() == person.fingers.size() &&
           std::ranges::all_of(person.fingers, [&](const PersonFinger& finger) {
             const PersonFinger* found = read.find(finger.name);
             return found != nullptr && keys_of(*found) == keys_of(finger);
           });
  } catch (const InputError&) {
    return false;
  }
}

/// The person's text with what is new in it, as little else changed as can be.
std::string changed_text(const Person& person) {
  if (person.text.empty()) return text_of(person);
  const Person before = read_person(ConfigFile(person.file, person.text));
  std::string text = person.text;
  for (const PersonFinger& finger : person.fingers) {
    const PersonFinger* known = before.find(finger.name);
    const std::vector<WrittenKey> old =
        known != nullptr ? keys_of(*known) : std::vector<WrittenKey>{};
    for (const WrittenKey& key : keys_of(finger)) {
      if (std::ranges::find(old, key) != old.end()) continue;
      text = with_key(text, finger.name, key.table, key.key, key.value);
    }
  }
  // Words that with_key() does not know, such as inline tables: then all is written anew.
  return says(text, person) ? text : text_of(person);
}

}  // namespace

const PersonFinger* Person::find(std::string_view name) const {
  const auto found = std::ranges::find(fingers, name, &PersonFinger::name);
  return found == fingers.end() ? nullptr : &*found;
}

PersonFinger& Person::at(std::string_view name) {
  const auto found = std::ranges::find(fingers, name, &PersonFinger::name);
  if (found != fingers.end()) return *found;
  PersonFinger& added = fingers.emplace_back();
  added.name = name;
  return added;
}

std::string person_schema() {
  const ConfigFile config("person.toml",
                          "[index.size]\n[index.registration]\ntranslation_mm = [0.0, 0.0, 0.0]\n"
                          "rotation_vector_deg = [0.0, 0.0, 0.0]\n[index.tissue]\n[index.mount]\n"
                          "translation_mm = [0.0, 0.0, 0.0]\n"
                          "rotation_vector_deg = [0.0, 0.0, 0.0]\n");
  static_cast<void>(read_person(config));
  return config.schema("softfinger person file");
}

Person load_person(const fs::path& file) {
  const std::string text = read_text_file(file, kMostBytes);
  Person person = read_person(ConfigFile(file, text));
  person.file = file;
  person.text = text;
  return person;
}

Person load_person_if_any(const fs::path& file) {
  std::error_code error;
  if (fs::exists(file, error) || error) return load_person(file);
  Person person;
  person.file = file;
  return person;
}

void save_person(const Person& person) {
  const std::string text = changed_text(person);
  // Through a link, so that what it names is replaced and not the link.
  std::error_code error;
  const fs::path target = fs::weakly_canonical(person.file, error);
  const fs::path& file = error ? person.file : target;
  // It is of a person's body: nobody else's to read.
  if (write_file_whole(file, [&](std::ostream& stream) { stream << text; },
                       {.owner_alone = true, .durable = true})) {
    return;
  }
  throw OperationError(fmt::format("{}: cannot be written", person.file.string()));
}

}  // namespace softfinger
