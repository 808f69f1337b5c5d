#pragma once

#include <array>

#include "softfinger/device/contacting_surface.hpp"

namespace softfinger {

/// A flat disk, see disk_geometry.hpp, carried by one body of at most three degrees of freedom. It
/// gives the Gauss-Newton matrix for second derivatives.
class DiskSurface : public ContactingSurface {
 public:
  /// m; `edge_radius`: of the solid's rim.
  DiskSurface(double radius, double edge_radius) : radius_(radius), edge_radius_(edge_radius) {}

  [[nodiscard]] ClosestPointResidual closest_point_residual(const Kinematics& by,
                                                            const Configuration& q,
                                                            const Vector3& p_F) const override;
  [[nodiscard]] SurfaceDistance signed_distance(const Kinematics& by, const Configuration& q,
                                                const Vector3& p_F) const override;
  [[nodiscard]] double deviation(const Kinematics& by, const Configuration& q,
                                 const SurfaceSamples& samples) const override;
  double deviation_derivatives(const Kinematics& by, const Configuration& q,
                               const SurfaceSamples& samples, Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] double least_distance(const Kinematics& by, const Configuration& q,
                                      const SurfaceSamples& samples) const override;
  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;
  [[nodiscard]] double disk_radius() const override { return radius_; }
  [[nodiscard]] double disk_edge_radius() const override { return edge_radius_; }

 private:
  /// The disk at one q: a point p_P fixed in F moves in P by turn_k p_P + shift_k per q_k.
  struct Motion {
    Pose X_PF;
    std::array<Matrix3, 3> turn;
    std::array<Vector3, 3> shift;
    int count = 0;

    /// By column; the last are zero where there are fewer than three.
    [[nodiscard]] Matrix3 rates(const Vector3& p_P) const;
  };
  [[nodiscard]] static Motion in_disk(const Pose& X_FB, const RigidMotion& motion);
  /// Of the closest-point residual by p_P.
  [[nodiscard]] Matrix3 residual_rate(const Vector3& p_P) const;

  double radius_, edge_radius_;
};

}  // namespace softfinger
