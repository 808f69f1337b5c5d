#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "softfinger/device/kinematics.hpp"
#include "softfinger/device/surface_samples.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

using SurfaceJacobian =
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxDegreesOfFreedom>;

/// From the nearest point of the contacting surface to a point: its squared norm is dist^2.
struct ClosestPointResidual {
  Vector3 residual;          ///< m, in a frame that moves with the surface
  SurfaceJacobian jacobian;  ///< by q, 3 x dof
};

/// Signed distance of a point to the device's solid, positive outside.
struct SurfaceDistance {
  double distance;         ///< m
  Configuration gradient;  ///< by q, dof
};

/// A rigid part of the solid that presses the wearer's finger.
struct SolidPiece {
  Shape shape;
  Pose X_FS;  ///< its frame in F
};

class PinField;

/// What touches the wearer's finger, wherever a kinematics `by` takes it. It asks the kinematics
/// once for each call. Immutable and shared by threads; nothing but the constructors and mounted()
/// allocates or throws.
class ContactingSurface : public std::enable_shared_from_this<ContactingSurface> {
 public:
  virtual ~ContactingSurface() = default;
  ContactingSurface(const ContactingSurface&) = delete;
  ContactingSurface& operator=(const ContactingSurface&) = delete;

  [[nodiscard]] virtual ClosestPointResidual closest_point_residual(const Kinematics& by,
                                                                    const Configuration& q,
                                                                    const Vector3& p_F) const = 0;
  [[nodiscard]] virtual SurfaceDistance signed_distance(const Kinematics& by,
                                                        const Configuration& q,
                                                        const Vector3& p_F) const = 0;
  /// Contact surface deviation E(q) = sum over C of w dist^2 + sum over N of w min(0, sdist -
  /// eps)^2, m^2.
  [[nodiscard]] virtual double deviation(const Kinematics& by, const Configuration& q,
                                         const SurfaceSamples& samples) const = 0;
  /// The same with dE/dq (dof), the Gauss-Newton matrix 2 J^T J and the exact second derivative
  /// d2E/dq2 (both dof x dof), all overwritten. Surfaces that have no second derivative give the
  /// Gauss-Newton matrix for both.
  virtual double deviation_derivatives(const Kinematics& by, const Configuration& q,
                                       const SurfaceSamples& samples,
                                       Eigen::Ref<Eigen::VectorXd> gradient,
                                       Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                       Eigen::Ref<Eigen::MatrixXd> hessian) const = 0;
  /// Least signed distance over points, m; infinity if there are none.
  [[nodiscard]] virtual double least_distance(const Kinematics& by, const Configuration& q,
                                              const SurfaceSamples& samples) const = 0;

  /// The same in a device that is mounted elsewhere: itself, of all but surfaces that know where.
  [[nodiscard]] virtual std::shared_ptr<const ContactingSurface> mounted(
      const Pose& /*X_FB*/) const {
    return shared_from_this();
  }
  /// Pose of the surface's frame in F; z towards the finger. That of what carries it, where not
  /// said otherwise.
  [[nodiscard]] virtual Pose pose(const Kinematics& by, const Configuration& q) const {
    return by.mount() * by.pose(q);
  }
  /// The solid that presses a finger at q, as solid_piece_count() parts. It is what the surface
  /// above is an ideal of: with the thickness and rounded rims of the thing itself.
  [[nodiscard]] virtual int solid_piece_count() const { return 1; }
  virtual void solid_pieces(const Kinematics& by, const Configuration& q,
                            std::span<SolidPiece> pieces) const = 0;

  /// The pins of a surface made of pins that move one by one, component k of q the height of pin k;
  /// null for other surfaces.
  [[nodiscard]] virtual const PinField* pin_field() const { return nullptr; }
  /// Radius of a disk surface, m; 0 for other surfaces.
  [[nodiscard]] virtual double disk_radius() const { return 0.0; }
  /// Rounding of the disk's rim, for the solid that presses a finger, m.
  [[nodiscard]] virtual double disk_edge_radius() const { return 0.0; }
  /// Radius of the ring that a cap bulges from, m: of the ball that is its first solid piece only
  /// what is above the ring is the cap. 0 for other surfaces.
  [[nodiscard]] virtual double cap_radius() const { return 0.0; }

 protected:
  ContactingSurface() = default;
};

}  // namespace softfinger
