#include "softfinger/recording/record.hpp"

#include <cmath>
#include <concepts>

#include "softfinger/base/hash.hpp"
#include "softfinger/recording/record_fields.hpp"

namespace softfinger {
namespace {

void add(Hash& hash, const Configuration& numbers) {
  hash.add(std::span<const double>(numbers.data(), static_cast<std::size_t>(numbers.size())));
}

void add(Hash& hash, const StoredPose& pose) {
  hash.add(pose.translation).add(pose.rotation.coeffs());
}

// To the bit, but for the sign of zero, which SQLite does not keep.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(std::integral auto a, std::integral auto b) { return a == b; }

bool same(DeviceState a, DeviceState b) { return a == b; }

bool same(const Vector3& a, const Vector3& b) {
  return same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z());
}

bool same(const StoredPose& a, const StoredPose& b) {
  return same(a.translation, b.translation) && same(a.rotation.w(), b.rotation.w()) &&
         same(a.rotation.vec(), b.rotation.vec());
}

bool same(const Configuration& a, const Configuration& b) {
  if (a.size() != b.size()) return false;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!same(a[i], b[i])) return false;
  }
  return true;
}

bool same(Targets<const FormedCommand> a, Targets<const FormedCommand> b) {
  return a.command.servos == b.command.servos && a.command.targets == b.command.targets;
}

// A field that one of the two does not say.
bool unsaid(double a, double b) { return std::isnan(a) || std::isnan(b); }
bool unsaid(const Vector3& a, const Vector3& b) { return a.hasNaN() || b.hasNaN(); }
template <typename Value>
bool unsaid(const Value&, const Value&) {
  return false;
}

template <typename Fields, typename Record>
const char* first_part(Fields fields, const Record& a, const Record& b) {
  RecordPart first = RecordPart::kNotCompared;
  for_each_field(fields, [&](const auto& field) {
    if (field.use.part >= first || same(field.of(a), field.of(b))) return;
    if (field.use.newer && unsaid(field.of(a), field.of(b))) return;
    first = field.use.part;
  });
  return first == RecordPart::kNotCompared ? nullptr
                                           : kRecordPartNames[static_cast<std::size_t>(first)];
}

}  // namespace

std::uint64_t hash_of(const TickRecord& tick) {
  Hash hash;
  hash.add(tick.tick).add(tick.step).add(tick.tracked).add(tick.emergency);
  add(hash, tick.reading.configuration);
  hash.add(tick.reading.normal_force).add(tick.travel_offset);
  add(hash, tick.wanted);
  add(hash, tick.command.configuration);
  add(hash, tick.command.joints);
  const auto servos = static_cast<std::size_t>(tick.command.servos);
  hash.add(std::span<const std::int32_t>(tick.command.targets.data(), servos));
  hash.add(tick.command.state);
  return hash.value();
}

std::uint64_t hash_of(const StepRecord& step, std::uint64_t state, std::uint64_t tick) {
  Hash hash;
  hash.add(step.step).add(step.tracked.valid);
  add(hash, step.tracked.X_WFt);
  add(hash, step.X_WF);
  hash.add(state).add(step.tick).add(tick);
  return hash.value();
}

const char* first_difference(const StepRecord& recorded, const StepRecord& replayed) {
  return first_part(kStepFields, recorded, replayed);
}

const char* first_difference(const TickRecord& recorded, const TickRecord& replayed) {
  return first_part(kTickFields, recorded, replayed);
}

const char* first_difference(const ObjectRecord& recorded, const ObjectRecord& replayed) {
  return first_part(kObjectFields, recorded, replayed);
}

const char* first_difference(const EventRecord& recorded, const EventRecord& replayed) {
  return first_part(kEventFields, recorded, replayed);
}

}  // namespace softfinger
