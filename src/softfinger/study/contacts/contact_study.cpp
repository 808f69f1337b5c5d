#include "softfinger/study/contacts/contact_study.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/base/hash.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/study/named_file.hpp"
#include "softfinger/study/random.hpp"

namespace softfinger {
namespace {

constexpr int kMostContacts = 100'000'000;
constexpr const char* kContactsKind = "contacts";

/// `{ min, max, log }` in the unit of the key; `fallback` in it as well.
Spread read_spread(const ConfigTable& contacts, const char* key, Range range, Spread fallback) {
  const ConfigTable table = contacts.table_or_empty(key);
  const double unit = unit_scale(key);
  Spread spread;
  spread.min = table.number("min", range, fallback.min);
  spread.max = table.number("max", range, fallback.max);
  spread.log = table.boolean("log", fallback.log);
  if (spread.min > spread.max) table.fail("max", "must not be less than min");
  if (spread.log && !(spread.min > 0.0)) table.fail("min", "must be above 0 where log = true");
  spread.min *= unit;
  spread.max *= unit;
  return spread;
}

}  // namespace

double Spread::at(double u) const {
  if (!log) return min + u * (max - min);
  return std::exp(std::log(min) + u * (std::log(max) - std::log(min)));
}

bool is_contact_study(const std::filesystem::path& file) {
  const ConfigTable root = ConfigFile(file).root();
  return root.has_table("design") && root.table("design").has("kind") &&
         root.table("design").text("kind") == kContactsKind;
}

ContactStudy load_contact_study(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, ConfigFile::kMaxSize);
  const ConfigFile config(file, text);
  const ConfigTable root = config.root();
  ContactStudy study{.file = file,
                     .text = text,
                     .finger = named_file(root, "finger", Shipped::kFinger, file.parent_path(),
                                          root.text("finger"))};
  static_cast<void>(FingerModel::load(study.finger.path, study.finger.text.text()));
  if (const auto population = root.optional_table("population")) {
    study.population = read_population(*population);
  }
  const ConfigTable contacts = root.table_or_empty("contacts");
  std::vector<std::string> names = names_of(kPressedOn);
  if (contacts.has("objects")) names = contacts.texts("objects");
  for (const std::string& name : names) {
    const auto* row = row_named(kPressedOn, name);
    if (row == nullptr) {
      contacts.fail("objects", fmt::format("there is no object '{}'; expected some of {}", name,
                                           listed(names_of(kPressedOn), "and")));
    }
    study.shapes.push_back(row->value);
  }
  study.radius = read_spread(contacts, "radius_mm", Range::between(0.5, 1000.0), {2.0, 40.0, true});
  study.edge_radius =
      read_spread(contacts, "edge_radius_mm", Range::between(0.1, 20.0), {0.25, 2.0, true});
  study.at = read_spread(contacts, "at_mm", Range::between(-20.0, 20.0), {-4.0, 4.0, false});
  study.pitch =
      read_spread(contacts, "pitch_deg", Range::between(-60.0, 80.0), {-10.0, 30.0, false});
  study.depth = read_spread(contacts, "depth_mm", Range::between(0.05, 5.0), {0.5, 2.0, false});
  study.friction =
      read_spread(contacts, "friction_coefficient", Range::between(0.0, 10.0), {0.2, 1.0, false});
  study.contacts_a_press =
      static_cast<std::size_t>(contacts.integer("contacts_a_press", 1, 1000, 10));
  const ConfigTable design = root.table("design");
  static_cast<void>(design.choice("kind", {kContactsKind}));
  study.seed = static_cast<std::uint32_t>(design.integer("seed", 0, 2147483647, 1));
  study.size = static_cast<std::size_t>(design.integer("size", 1, kMostContacts));
  if (study.size % study.contacts_a_press != 0) {
    design.fail("size", fmt::format("must be a multiple of contacts_a_press, {}, found {}",
                                    study.contacts_a_press, study.size));
  }
  root.finish();
  return study;
}

DrawnPress draw_press(const ContactStudy& study, std::size_t number) {
  UnitRandom random(Hash().add(study.seed).add(std::uint64_t{number}).value());
  DrawnPress press;
  press.person = random.below(static_cast<std::size_t>(study.population.size));
  press.shape = study.shapes[random.below(study.shapes.size())];
  // Each press takes as many numbers, so that none depends on what another key says.
  const double size = random.next();
  if (press.shape == PressedOn::kSphere) press.radius = study.radius.at(size);
  if (press.shape == PressedOn::kEdge) press.radius = study.edge_radius.at(size);
  const double x = study.at.at(random.next());
  const double y = study.at.at(random.next());
  if (press.shape == PressedOn::kSphere) {
    press.at_x = x;
    press.at_y = y;
  }
  press.pitch = study.pitch.at(random.next());
  press.depth = study.depth.at(random.next());
  press.friction = study.friction.at(random.next());
  return press;
}

std::vector<StudyFact> contact_facts(const ContactStudy& study) {
  return study_facts(study.file, study.text, {&study.finger});
}

}  // namespace softfinger
