#pragma once

#include <memory>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/matching/surface_rendering.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// What weighs how much in
///   E(q) + w_f^2 |f_twin(q) - f_virtual|^2 + w_r^2 |q - q_before|^2 .
struct ForceAwareOptions {
  /// w_f, m/N. 0.05: a hundredth of a newton weighs like half a millimetre of one sample.
  double force_weight = 0.05;
  /// w_r, dimensionless, in the metric of the device's axes: decides where nothing else does.
  double inertia_weight = 0.05;
  int iterations = 4;          ///< Gauss-Newton steps a frame
  double max_angle = 0.15;     ///< rad a step
  double max_length = 0.6e-3;  ///< m a step
};

struct ForceAwareResult {
  Configuration configuration;
  Vector3 force = Vector3::Zero();  ///< of the twin there, see normal_force_vector(); F, N
  double deviation = 0.0;           ///< E there, m^2
  int iterations = 0;
};

/// Objective "surface_and_force": the configuration whose twin feels the virtual contact's normal
/// force, as far as the contact surface allows. Gauss-Newton on the cost above with the derivative
/// of the twin's equilibrium by the implicit function theorem (see Twin), limits as constraints of
/// a quadratic program. After the bilevel problem in Perez et al., "Optimization-based wearable
/// tactile rendering", IEEE Trans. Haptics 2017; ours are the force vector beside the surface term
/// and the derivatives. Allocates only in the constructor.
class ForceAwareMatching {
 public:
  /// `model`: the simulated finger, whose twin is pressed. `capacity`: most samples.
  ForceAwareMatching(std::shared_ptr<const FingerModel> model, std::shared_ptr<const Device> device,
                     int capacity, ForceAwareOptions options = {});
  ~ForceAwareMatching();
  ForceAwareMatching(ForceAwareMatching&&) noexcept;
  ForceAwareMatching& operator=(ForceAwareMatching&&) noexcept;

  void reset();
  /// One frame, `elapsed` s after the last: from `surface`, which is reachable, or from where the
  /// last frame ended if that is the better start. Where the virtual side touches nothing the twin
  /// only follows to `surface`.
  const ForceAwareResult& match(const ContactSet& virtual_side, const Configuration& surface,
                                double friction_coefficient, double elapsed,
                                const MatchingOptions& matching);
  [[nodiscard]] const Twin& twin() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
