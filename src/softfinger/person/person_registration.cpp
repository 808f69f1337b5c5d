#include "softfinger/person/person_registration.hpp"

namespace softfinger {

FingerSize completed(const FingerSize& sizes, const FingerSize& other) {
  return {.length = sizes.length ? sizes.length : other.length,
          .breadth = sizes.breadth ? sizes.breadth : other.breadth,
          .depth = sizes.depth ? sizes.depth : other.depth};
}

Registration register_person(Person& person, const RegistrationTask& task,
                             std::span<const PostureCapture> captures) {
  const FingerSize& measured = task.measured;
  const bool size_is_found =
      task.table_height && !measured.length && !measured.breadth && !measured.depth;
  const PersonFinger* before = person.find(task.finger);
  FingerSize known;
  if (!size_is_found) known = completed(measured, before != nullptr ? before->size : FingerSize{});
  const auto model = FingerModel::load(task.model, known);
  std::vector<Vector3> skin_F;
  for (const int node : model->sample_nodes) {
    skin_F.push_back(model->mesh.nodes[static_cast<std::size_t>(node)]);
  }
  Registration found =
      register_finger(captures, skin_F, task.table_height, /*size_known=*/!size_is_found);
  PersonFinger& finger = person.at(task.finger);
  finger.X_BodyFt = found.X_BodyFt;
  finger.size = finger_size(*model);
  for (auto* size : {&finger.size.length, &finger.size.breadth, &finger.size.depth}) {
    **size *= found.scale;
  }
  return found;
}

}  // namespace softfinger
