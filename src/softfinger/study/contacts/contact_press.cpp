#include "softfinger/study/contacts/contact_press.hpp"

#include <cstring>
#include <type_traits>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMostFingersKept = 512;
// Of an equilibrium; what is kept is single precision.
constexpr double kTolerance = 3e-7;
constexpr double kFrictionTolerance = 1e-5;  // N

/// Calls with each list of contacts, in the order in which they are sent.
template <typename Contacts, typename Call>
void each_list(Contacts& contacts, const Call& call) {
  call(contacts.indentation_mm);
  call(contacts.normal_force_N);
  call(contacts.tangential_force_N);
  call(contacts.contact_area_mm2);
  call(contacts.converged);
  call(contacts.nodes_mm);
  call(contacts.gap_mm);
  call(contacts.pressure_kPa);
  call(contacts.force_N);
  call(contacts.in_contact);
}

float in_file(double value, double unit) { return static_cast<float>(value / unit); }

void add(const Vector3& vector, double unit, std::vector<float>& list) {
  for (const double value : vector) list.push_back(in_file(value, unit));
}

void add_row(const IndentationState& state, PressedContacts& contacts) {
  contacts.indentation_mm.push_back(in_file(state.row.indentation, mm));
  contacts.normal_force_N.push_back(in_file(state.row.normal_force, 1.0));
  contacts.tangential_force_N.push_back(in_file(state.row.tangential_force, 1.0));
  contacts.contact_area_mm2.push_back(in_file(state.row.contact_area, mm2));
  contacts.converged.push_back(state.row.converged ? 1 : 0);
  const Pose X_FW = state.X_WF.inverse();
  for (const Vector3& node_W : state.positions) add(X_FW * node_W, mm, contacts.nodes_mm);
  for (const ContactSample& sample : state.contact.samples) {
    contacts.gap_mm.push_back(in_file(sample.gap, mm));
    contacts.pressure_kPa.push_back(in_file(sample.pressure(), kPa));
    add(sample.normal_force_F + sample.tangential_force_F, 1.0, contacts.force_N);
    contacts.in_contact.push_back(sample.in_contact ? 1 : 0);
  }
}

Indenter indenter_of(const DrawnPress& press) {
  if (press.shape == PressedOn::kSphere) {
    return Indenter::ball(press.radius, press.at_x, press.at_y);
  }
  return press.shape == PressedOn::kEdge ? Indenter::edge(press.radius) : Indenter::plane();
}

}  // namespace

std::string PressedContacts::bytes() const {
  std::string bytes;
  each_list(*this, [&bytes](const auto& list) {
    const std::uint64_t size = list.size() * sizeof(list[0]);
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes.append(reinterpret_cast<const char*>(list.data()), size);
  });
  return bytes;
}

PressedContacts PressedContacts::of_bytes(std::string_view bytes) {
  PressedContacts contacts;
  each_list(contacts, [&bytes](auto& list) {
    std::uint64_t size = 0;
    if (bytes.size() < sizeof size) throw OperationError("a press came back in part");
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.substr(sizeof size);
    if (bytes.size() < size) throw OperationError("a press came back in part");
    list.resize(size / sizeof(list[0]));
    if (size > 0) std::memcpy(list.data(), bytes.data(), size);
    bytes = bytes.substr(size);
  });
  return contacts;
}

ContactPress::ContactPress(const ContactStudy& study)
    : study_(study),
      people_(draw_people(study.population)),
      nominal_(FingerModel::load(study.finger.path, study.finger.text.text())) {}

std::shared_ptr<const FingerModel> ContactPress::finger(std::size_t person) {
  if (fingers_.size() >= kMostFingersKept && !fingers_.contains(person)) fingers_.clear();
  auto& kept = fingers_[person];
  if (!kept) kept = finger_of(nominal_, people_[person], study_.finger.text.text());
  return kept;
}

PressedContacts ContactPress::press(std::size_t number) {
  const DrawnPress drawn = draw_press(study_, number);
  FingerModel model = *finger(drawn.person);
  model.friction_coefficient = drawn.friction;
  PressedContacts contacts;
  const std::size_t rows = study_.contacts_a_press;
  try {
    indent(model, indenter_of(drawn),
           {.depth = drawn.depth,
            .rows = static_cast<int>(rows),
            .tolerance = kTolerance,
            .friction_tolerance = kFrictionTolerance,
            .pitch = drawn.pitch},
           [&contacts](const IndentationState& state) { add_row(state, contacts); });
  } catch (const InputError&) {
    contacts = {};  // it came down beside the object
    each_list(contacts, [rows](auto& list) { list.assign(rows, 0); });
    contacts.nodes_mm.assign(rows * 3 * model.mesh.nodes.size(), 0.0f);
    for (auto* list : {&contacts.gap_mm, &contacts.pressure_kPa}) {
      list->assign(rows * model.sample_nodes.size(), 0.0f);
    }
    contacts.force_N.assign(rows * 3 * model.sample_nodes.size(), 0.0f);
    contacts.in_contact.assign(rows * model.sample_nodes.size(), 0);
  }
  return contacts;
}

}  // namespace softfinger
