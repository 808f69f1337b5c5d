#include "softfinger/person/person_registration.hpp"

namespace softfinger {

FingerSize completed(const FingerSize& sizes, const FingerSize& other) {
  return {.length = sizes.length ? sizes.length : other.length,
          .breadth = sizes.breadth ? sizes.breadth : other.breadth,
          .depth = sizes.depth ? sizes.depth : other.depth};
}

namespace {

std::vector<Vector3> skin_of(const FingerModel& model) {
  std::vector<Vector3> skin_F;
  for (const int node : model.sample_nodes) {
    skin_F.push_back(model.mesh.nodes[static_cast<std::size_t>(node)]);
  }
  return skin_F;
}

}  // namespace

Registration register_person(Person& person, const RegistrationTask& task,
                             std::span<const PostureCapture> captures) {
  const FingerSize& measured = task.measured;
  const PersonFinger* before = person.find(task.finger);
  // What a device has learned by pressing is nearer the truth than one scale for all.
  const bool learned = before != nullptr && before->mount;
  const bool size_is_found =
      task.table_height && !learned && !measured.length && !measured.breadth && !measured.depth;
  FingerSize known;
  if (!size_is_found) known = completed(measured, before != nullptr ? before->size : FingerSize{});
  const auto model = FingerModel::load(task.model, known);
  Registration found =
      register_finger(captures, skin_of(*model), task.table_height, /*size_known=*/!size_is_found);
  PersonFinger& finger = person.at(task.finger);
  finger.X_BodyFt = found.X_BodyFt;
  finger.on_table = {.captures = {captures.begin(), captures.end()},
                     .height = found.table_height,
                     .height_was_given = task.table_height.has_value()};
  finger.size = finger_size(*model);
  for (auto* size : {&finger.size.length, &finger.size.breadth, &finger.size.depth}) {
    **size *= found.scale;
  }
  return found;
}

std::optional<Registration> register_again(PersonFinger& finger,
                                           const std::filesystem::path& model) {
  if (!finger.on_table) return std::nullopt;
  TableRest& rest = *finger.on_table;
  const std::optional<double> given =
      rest.height_was_given ? std::optional(rest.height) : std::nullopt;
  const Registration found = register_finger(
      rest.captures, skin_of(*FingerModel::load(model, finger.size)), given, /*size_known=*/true);
  finger.X_BodyFt = found.X_BodyFt;
  rest.height = found.table_height;
  return found;
}

}  // namespace softfinger
