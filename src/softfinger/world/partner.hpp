#pragma once

#include <vector>

#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/finger/obstacle_coupling.hpp"

namespace softfinger {

/// A finger or a soft object, and how it and the bodies that it touches depend on each other while
/// its factor is kept.
struct Partner {
  /// Of so many bodies, the first `most` that it touches. `number`: as the world counts partners.
  Partner(FingerSimulation& finger, std::size_t number, std::size_t most);

  FingerSimulation* finger;
  std::size_t number;
  std::vector<ObstacleCoupling> couplings;
  std::vector<std::size_t> bodies;  ///< of the couplings in use
  std::vector<Matrix6> yielding;    ///< -B^T A^-1 B of each pair of couplings, as factored
  std::vector<Vector3> carried;     ///< by contact point, N
  bool coupled = false;             ///< since it was last factored together with its bodies
  bool met_soft = false;            ///< something soft was near it in its last step

  /// Nothing is known of the bodies.
  void forget();
  void find_yielding();
  /// Load on the body of a coupling in its own direction.
  [[nodiscard]] Vector6 load(std::size_t coupling) const;
};

}  // namespace softfinger
