#include "softfinger/world/partner.hpp"

#include <span>

#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {
namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

Partner::Partner(FingerSimulation& simulation, std::size_t n, std::size_t most)
    : finger(&simulation), number(n) {
  const ObstacleCoupling none = simulation.potential().make_coupling();
  couplings.assign(most, none);
  bodies.reserve(most);
  yielding.resize(most * most);
  carried.assign(none.by_point.size(), Vector3::Zero());
}

void Partner::forget() {
  bodies.clear();
  coupled = false;
}

void Partner::find_yielding() {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    for (std::size_t l = 0; l < bodies.size(); ++l) {
      Matrix6& block = yielding[k * couplings.size() + l];
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) {
          block(r, c) = -dot(couplings[k].columns[static_cast<std::size_t>(r)],
                             couplings[l].responses[static_cast<std::size_t>(c)]);
        }
      }
    }
  }
}

Vector6 Partner::load(std::size_t coupling) const {
  const std::span<const double> alone = finger->potential().direction();
  Vector6 sum;
  for (int c = 0; c < 6; ++c) {
    sum[c] = dot(couplings[coupling].columns[static_cast<std::size_t>(c)], alone);
  }
  return sum;
}

}  // namespace softfinger
