#pragma once

#include <limits>
#include <memory>
#include <span>
#include <stop_token>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// How one press of the twin ended.
struct TwinSummary {
  int iterations = 0;
  bool converged = true;
};

/// How fully equilibria are solved for: to judge a device by, or to search among configurations,
/// several times as fast, with forces to a thousandth.
enum class TwinPrecision { kJudging, kSearching };

/// Normal contact force of device on skin, as one vector: the sum of the normal forces; in F, N.
[[nodiscard]] Vector3 normal_force_vector(const ContactSet& contact);

/// Contact forces of device on skin, summed as vectors in F, N, and their derivatives by q
/// (3 x dof, N by rad or m).
struct TwinForces {
  Vector3 normal = Vector3::Zero();
  Vector3 tangential = Vector3::Zero();
  SurfaceJacobian normal_by_q, tangential_by_q;
};

/// What the skin presses the device with, component by component of q, N m by rad or N by m: load
/// . dq is the work that it does on the device; and the derivative of that by q.
struct DeviceLoad {
  Eigen::VectorXd load;
  Eigen::MatrixXd by_q;
};

/// A second finger in F: bone held at F's origin, skin at quasi-static equilibrium against the
/// device's solid, so that its contact is what the device makes the wearer feel. The way there
/// counts where there is friction or relaxation: each frame starts from the last one kept.
/// Allocates only in the constructor.
class Twin {
 public:
  /// `wearer` may differ from the simulated finger in size and constants.
  Twin(std::shared_ptr<const FingerModel> wearer, std::shared_ptr<const Device> device,
       TwinPrecision precision = TwinPrecision::kJudging);
  ~Twin();
  Twin(Twin&&) noexcept;
  Twin& operator=(Twin&&) noexcept;

  /// From now on presses end soon, and unconverged, once `stop` asks for it.
  void heed(const std::stop_token& stop);
  /// Rest shape, nothing touches, the device at its home.
  void reset();
  /// The same with the device at q, off the skin: for a search that begins there. What turned far
  /// in one attempt would be taken to have swept through the skin.
  void reset(const Configuration& q);
  /// The same on the skin, all of whose nodes begin near `positions` (F, m).
  void reset(const Configuration& q, std::span<const Vector3> positions);
  /// Moves the device to q in one frame, in as many parts as friction needs, `elapsed` s after the
  /// last one (relaxing skin only). `friction_coefficient` of device on skin, >= 0.
  TwinSummary press(const Configuration& q, double friction_coefficient, double elapsed);

  // A frame in pieces, for those who look for a q: any number of attempts, of which the last stays.
  // One that would take more than `most_iterations` of Newton's method is given up: it does not
  // converge, the next one begins where it had begun, and it may not be kept.
  void begin_frame(double friction_coefficient, double elapsed);
  static constexpr int kAsManyAsItTakes = std::numeric_limits<int>::max();
  TwinSummary attempt(const Configuration& q, int most_iterations = kAsManyAsItTakes);
  void keep();
  /// keep() with the device at q, wherever it was tried, by the way that press() takes.
  void end_frame(const Configuration& q);

  /// Of the last attempt.
  [[nodiscard]] const Configuration& configuration() const;
  /// Forces at the last attempt and their derivatives, by the implicit function theorem: the skin's
  /// equilibrium moves with q. The device's own motion is by differences of its pieces' poses, all
  /// else exact, friction limits and planes that follow the normal forces included. What sticks
  /// goes on sticking, what slides sliding. False where the equilibrium is not stable enough to be
  /// solved for.
  [[nodiscard]] bool forces_and_derivatives(TwinForces& forces);
  /// The normal force of it alone.
  [[nodiscard]] bool force_and_derivative(Vector3& force, SurfaceJacobian& by_q);

  /// The same as what the device has to bear. The derivative leaves out that the directions in
  /// which its points move turn with q, and is 0 where false comes back.
  [[nodiscard]] bool load_and_derivative(DeviceLoad& load);

  /// How the normal force (its magnitude) grows as the whole device moves against the bone:
  /// translations along F's axes, N/m, then rotations about `origin_F` (m), N/rad; and the
  /// derivative by q, N by rad or m. As forces_and_derivatives() otherwise.
  [[nodiscard]] bool force_by_mount(const Vector3& origin_F, Vector6& by_mount,
                                    Eigen::VectorXd& by_q);
  /// After force_by_mount(): how much greater the normal force of `other` than that of `same` would
  /// be in equilibrium where this twin is, to first order, N. Twins of the same mesh and device, of
  /// which `same` has this one's finger and `other` one that is hardly different in size and
  /// moduli; both are put out of their states.
  [[nodiscard]] double force_difference(Twin& same, Twin& other) const;

  /// How node `node` moves by component k of q, m by rad or m: after forces_and_derivatives(), zero
  /// where that found no contact.
  [[nodiscard]] Vector3 node_motion(std::size_t node, int k) const;

  [[nodiscard]] const FingerModel& wearer() const;
  [[nodiscard]] const Device& device() const;
  /// Contact with the device, in F, of the last attempt.
  [[nodiscard]] const ContactSet& contact() const;
  /// All nodes, in F, m, of the last attempt.
  [[nodiscard]] std::span<const Vector3> positions() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
