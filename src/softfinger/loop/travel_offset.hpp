#pragma once

#include <memory>

#include "softfinger/device/force_reading.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

struct TravelOffsetOptions {
  double gain = 0.7;               ///< part of the error that is corrected in one frame
  double max_change = 0.3e-3;      ///< a frame, m
  double max_offset = 3e-3;        ///< m
  double least_force = 0.05;       ///< N; less on both sides tells nothing
  double least_stiffness = 300.0;  ///< N/m
  bool refine = false;             ///< learns how far the device has slipped aside, too
  double max_slip = 2e-3;          ///< m, along either axis
};

/// How much nearer to the device the wearer's skin is than the model's, estimated from measured
/// force: a finger of another size is another travel. A twin is pressed as the device presses the
/// wearer by the present estimate; what it feels less than was measured, divided by how its force
/// grows with advance, is the estimate's next change. Stiffness is corrected for as well, with the
/// delay of the measurement. A sensor that says the same number again and again may be dead or
/// stuck, and corrects nothing.
///
/// A device that has slipped aside by s, in F, is nearer where its surface is tilted: by n . s with
/// n the direction in which the surface faces. With `refine` that s is learned, slowly and within
/// bounds, from how the estimate would have to change as the device tilts: a Kalman filter (Kalman
/// 1960) of how much nearer it is everywhere, which wanders, and of the slip, which wanders less.
/// update() does not allocate.
class TravelOffset {
 public:
  /// `model`: the simulated finger.
  TravelOffset(std::shared_ptr<const FingerModel> model, std::shared_ptr<const Device> device,
               TravelOffsetOptions options = {});

  /// No estimate.
  void reset();
  /// One frame, `elapsed` s after the last (relaxing skin only).
  void update(const ForceReading& reading, double friction_coefficient, double elapsed);
  /// With the device at q, m; above zero: the wearer is nearer.
  [[nodiscard]] double at(const Configuration& q) const;
  /// The same where its surface faces along z of F.
  [[nodiscard]] double value() const { return state_.z(); }
  /// How far the device has slipped along x and y of F, m; zero where that is not learned.
  [[nodiscard]] Eigen::Vector2d slip() const { return state_.head<2>(); }
  /// The configuration for the wearer that does what q does for the model; limits are not looked
  /// at.
  [[nodiscard]] Configuration corrected(const Configuration& q) const;
  /// The configuration that does for the model what q does for the wearer.
  [[nodiscard]] Configuration felt(const Configuration& q) const;

 private:
  /// How the estimate at q follows from the state.
  [[nodiscard]] Vector3 weights(const Configuration& q) const;
  void change(const Vector3& weights, double lack);

  TravelOffsetOptions options_;
  Twin twin_;
  Vector3 state_ = Vector3::Zero();       ///< slip along x and y of F, and nearness, m
  Matrix3 covariance_ = Matrix3::Zero();  ///< of it, over that of a frame's measurement
  double last_force_ = 0.0;               ///< N, measured
  int repeats_ = 0;                       ///< how often in a row it was the same
  double stiffness_;                      ///< last known, N/m
};

}  // namespace softfinger
