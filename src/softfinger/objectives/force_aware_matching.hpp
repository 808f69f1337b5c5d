#pragma once

#include <memory>
#include <span>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// What weighs how much in
///   w_e^2 E(q) + w_f^2 |f_twin(q) - f_virtual|^2 + w_t^2 |P (t_twin(q) - t_virtual)|^2
///     + w_s^2 sum V |s_twin(q) - s_virtual|^2 / sum V
///     + w_r^2 |q - q_before|^2 + w_a^2 |q - q_surface|^2 ,
/// f normal and t tangential force, P shear_projection() of the device, s Cauchy stress of the soft
/// elements, V their rest volumes, all in F.
struct ForceAwareOptions {
  double surface_weight = 1.0;  ///< w_e, dimensionless
  /// w_f, m/N. 0.05: a hundredth of a newton weighs like half a millimetre of one sample.
  double force_weight = 0.05;
  /// w_t, m/N. Half as much: where both cannot be had, the normal force is.
  double tangential_weight = 0.025;
  /// w_s, m/Pa; 0: stresses are not looked at.
  double stress_weight = 0.0;
  /// w_r, dimensionless, in the metric of the device's axes: decides where nothing else does.
  double inertia_weight = 0.05;
  /// w_a, likewise: what moves neither surface nor force, a disk's turn about its own axis, does
  /// not wander off with the skin that it drags along.
  double anchor_weight = 0.3;
  int iterations = 4;          ///< Gauss-Newton steps a frame that gain, of at most 5 attempts
  double max_angle = 0.15;     ///< rad a step
  double max_length = 0.6e-3;  ///< m a step

  /// Of objective "stress": the stress alone, but for what it says nothing of. A kilopascal (root
  /// of the mean square) weighs like a millimetre of one sample.
  [[nodiscard]] static ForceAwareOptions stress() {
    return {.surface_weight = 0.05,
            .force_weight = 0.0,
            .tangential_weight = 0.0,
            .stress_weight = 1e-6};
  }
};

struct ForceAwareResult {
  Configuration configuration;
  Vector3 force = Vector3::Zero();  ///< of the twin there, see normal_force_vector(); F, N
  Vector3 tangential_force = Vector3::Zero();  ///< of the twin there; F, N
  double deviation = 0.0;                      ///< E there, m^2
  int iterations = 0;
};

/// Objectives "surface_and_force" and "stress": the configuration whose twin feels the virtual
/// contact's normal force, as far as the contact surface allows, and its tangential force along the
/// directions in which the device can shear; or bears the virtual finger's
/// stress below the skin (Verschoor et al., "Tactile rendering based on skin stress optimization",
/// ACM Trans. Graphics 2020, match skin stress; the measure is ours). Gauss-Newton on the cost
/// above with the derivative of the twin's equilibrium by the implicit function theorem (see Twin),
/// corrected by secants (see SecantForces) from attempt to attempt and from frame to frame; limits
/// as constraints of a quadratic program. After the bilevel problem in Perez et al.,
/// "Optimization-based wearable tactile rendering", IEEE Trans. Haptics 2017; ours are the force
/// vector beside the surface term and the derivatives. Allocates only in the constructor.
class ForceAwareMatching {
 public:
  /// `model`: the simulated finger, whose twin is pressed. `capacity`: most samples; features have
  /// room besides.
  ForceAwareMatching(const std::shared_ptr<const FingerModel>& model,
                     std::shared_ptr<const Device> device, int capacity,
                     ForceAwareOptions options = {});
  ~ForceAwareMatching();
  ForceAwareMatching(ForceAwareMatching&&) noexcept;
  ForceAwareMatching& operator=(ForceAwareMatching&&) noexcept;

  void reset();
  /// One frame, `elapsed` s after the last: from `surface`, which is reachable, or from where the
  /// last match was if that is the better start. Where the virtual side touches nothing the twin
  /// only follows to `surface`. `nodes_F`: all nodes of the virtual finger, m; only looked at where
  /// stresses weigh something.
  const ForceAwareResult& match(const ContactSet& virtual_side, const Configuration& surface,
                                double friction_coefficient, double elapsed,
                                const MatchingOptions& matching,
                                std::span<const Vector3> nodes_F = {});
  /// Where the device went in this frame: where its limits led it elsewhere, friction and
  /// relaxation of the twin follow there. Without it, it is taken to have gone to the match.
  void follow(const Configuration& went);
  /// E at q of the samples of the last match, m^2.
  [[nodiscard]] double deviation(const Configuration& q) const;
  [[nodiscard]] const Twin& twin() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
