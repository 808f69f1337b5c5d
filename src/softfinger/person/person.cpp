#include "softfinger/person/person.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostFingers = 64;
constexpr Range kOffset_mm{.min = -500.0, .max = 500.0};
constexpr Range kTurn_deg{.min = -360.0, .max = 360.0};

PersonFinger read_finger(const ConfigTable& table, const std::string& name) {
  PersonFinger finger;
  finger.name = name;
  if (const auto size = table.optional_table("size")) finger.size = read_finger_size(*size);
  if (const auto registration = table.optional_table("registration")) {
    const Vector3 translation = registration->numbers("translation_mm", 3, kOffset_mm);
    const Vector3 turn = registration->numbers("rotation_vector_deg", 3, kTurn_deg);
    finger.X_BodyFt = Pose{exp_rotation(turn), translation};
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

std::string text_of(const PersonFinger& finger) {
  std::string text;
  const auto& [length, breadth, depth] = finger.size;
  if (length || breadth || depth) {
    text += fmt::format("\n[{}.size]\n", finger.name);
    if (length) text += fmt::format("length_mm = {}\n", number(*length, mm));
    if (breadth) text += fmt::format("breadth_mm = {}\n", number(*breadth, mm));
    if (depth) text += fmt::format("depth_mm = {}\n", number(*depth, mm));
  }
  if (finger.X_BodyFt) {
    text += fmt::format("\n[{}.registration]\ntranslation_mm = {}\nrotation_vector_deg = {}\n",
                        finger.name, numbers(finger.X_BodyFt->translation, mm),
                        numbers(log_rotation(finger.X_BodyFt->rotation), deg));
  }
  // A table that said nothing stays as well.
  return text.empty() ? fmt::format("\n[{}]\n", finger.name) : text;
}

}  // namespace

const PersonFinger* Person::find(std::string_view name) const {
  const auto found = std::ranges::find(fingers, name, &PersonFinger::name);
  return found == fingers.end() ? nullptr : &*found;
}

PersonFinger& Person::at(std::string_view name) {
  const auto found = std::ranges::find(fingers, name, &PersonFinger::name);
  if (found != fingers.end()) return *found;
  return fingers.emplace_back(PersonFinger{.name = std::string(name), .size = {}, .X_BodyFt = {}});
}

std::string person_schema() {
  const ConfigFile config("person.toml",
                          "[index.size]\n[index.registration]\ntranslation_mm = [0.0, 0.0, 0.0]\n"
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
  std::string text = "# Fingers of one person: sizes, and where the tracked body sits on them.\n";
  for (const PersonFinger& finger : person.fingers) text += text_of(finger);
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
