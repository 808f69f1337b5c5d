#include "softfinger/recording/record.hpp"

#include <cmath>

#include "softfinger/base/hash.hpp"

namespace softfinger {
namespace {

void add(Hash& hash, const Configuration& numbers) {
  hash.add(std::span<const double>(numbers.data(), static_cast<std::size_t>(numbers.size())));
}

void add(Hash& hash, const StoredPose& pose) {
  hash.add(pose.translation).add(pose.rotation.coeffs());
}

// Recordings made before there was the field have NaN.
bool same_or_not_recorded(double a, double b) { return std::isnan(a) || std::isnan(b) || a == b; }

// To the bit, but for the sign of zero, which SQLite does not keep.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

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

const char* first_difference(const StepRecord& a, const StepRecord& b) {
  if (a.step != b.step || a.finger != b.finger) return "step";
  if (!same(a.tracked.X_WFt, b.tracked.X_WFt) || a.tracked.valid != b.tracked.valid)
    return "tracked pose";
  if (!same(a.X_WF, b.X_WF)) return "bone pose";
  if (a.contact_count != b.contact_count || !same(a.contact_area, b.contact_area) ||
      !same(a.normal_force, b.normal_force) || !same(a.tangential_force, b.tangential_force) ||
      !same(a.slip_ratio, b.slip_ratio) || !same(a.stuck_fraction, b.stuck_fraction) ||
      !same(a.centroid_F, b.centroid_F) || !same(a.mean_normal_F, b.mean_normal_F) ||
      !same(a.least_gap, b.least_gap) ||
      !same_or_not_recorded(a.normal_force_sum, b.normal_force_sum)) {
    return "contact";
  }
  if (a.iterations != b.iterations || a.converged != b.converged || !same(a.residual, b.residual)) {
    return "solution";
  }
  if (a.hash != b.hash) return "state, configuration or command";
  return nullptr;
}

const char* first_difference(const TickRecord& a, const TickRecord& b) {
  if (a.step != b.step || a.finger != b.finger || a.tick != b.tick || a.tracked != b.tracked ||
      a.emergency != b.emergency || !same(a.reading.configuration, b.reading.configuration) ||
      !same(a.reading.normal_force, b.reading.normal_force)) {
    return "device tick";
  }
  if (!same(a.wanted, b.wanted) || !same(a.deviation, b.deviation) ||
      a.iterations != b.iterations || !same(a.travel_offset, b.travel_offset)) {
    return "matching";
  }
  if (!same(a.command.configuration, b.command.configuration) ||
      !same(a.command.joints, b.command.joints) || a.command.servos != b.command.servos ||
      a.command.targets != b.command.targets || a.command.state != b.command.state) {
    return "command";
  }
  if (a.hash != b.hash) return "configuration or command";
  return nullptr;
}

}  // namespace softfinger
